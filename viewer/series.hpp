// SPDX-License-Identifier: BSD-3-Clause
/// @file Figures over time, for the page's plots, in a bounded number of rows.
#pragma once
#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

namespace modslam {

/// Means over intervals of message time. A row more than kMaxRows doubles the interval and joins
/// rows in pairs: a long run is kept whole, only coarser.
class Series {
 public:
  static constexpr std::size_t kMaxRows = 600;
  enum Figure { kError_m, kSigma_m, kOk, kDegenerate, kBad, kLatency_ms, kMissing, kFigures };

  /// A value of figure `what` at `utime` [us]; stamps that step back count in the newest row.
  void add(std::int64_t utime, Figure what, double value);
  void clear() { *this = Series(); }
  /// {t: [s], begin_utime, and an array for each figure; null where there was no value}
  nlohmann::json to_json() const;
  std::size_t rows() const { return rows_.size(); }
  double interval_s() const { return static_cast<double>(interval_us_) * 1e-6; }

 private:
  struct Row {
    std::int64_t slot = 0;
    std::array<double, kFigures> sum{};
    std::array<int, kFigures> count{};
  };
  void join_pairs();

  std::int64_t interval_us_ = 500'000, begin_utime_ = 0;
  std::vector<Row> rows_;
};

}  // namespace modslam
