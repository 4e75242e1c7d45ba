// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/series.hpp"

#include <algorithm>
#include <cmath>

namespace modslam {

void Series::add(std::int64_t utime, Figure what, double value) {
  if (!std::isfinite(value)) return;
  if (rows_.empty()) begin_utime_ = utime;
  std::int64_t slot = std::max<std::int64_t>(0, utime - begin_utime_) / interval_us_;
  if (!rows_.empty()) slot = std::max(slot, rows_.back().slot);
  if (rows_.empty() || rows_.back().slot != slot) {
    if (rows_.size() == kMaxRows) {
      join_pairs();
      slot /= 2;
    }
    if (rows_.empty() || rows_.back().slot != slot) rows_.push_back({slot, {}, {}});
  }
  rows_.back().sum[what] += value;
  ++rows_.back().count[what];
}

void Series::join_pairs() {
  interval_us_ *= 2;
  std::vector<Row> joined;
  for (const Row& row : rows_) {
    if (joined.empty() || joined.back().slot != row.slot / 2)
      joined.push_back({row.slot / 2, {}, {}});
    for (std::size_t i = 0; i < kFigures; ++i) {
      joined.back().sum[i] += row.sum[i];
      joined.back().count[i] += row.count[i];
    }
  }
  rows_ = std::move(joined);
}

nlohmann::json Series::to_json() const {
  static const char* const kNames[kFigures] = {"error_m", "sigma_m",    "ok",     "degenerate",
                                               "bad",     "latency_ms", "missing"};
  using nlohmann::json;
  const auto rounded = [](double v) { return std::round(v * 1e4) / 1e4; };
  json columns = {{"t", json::array()}, {"begin_utime", begin_utime_}};
  for (const char* name : kNames) columns[name] = json::array();
  for (const Row& row : rows_) {
    columns["t"].push_back(rounded((static_cast<double>(row.slot) + 0.5) * interval_s()));
    for (std::size_t i = 0; i < kFigures; ++i)
      columns[kNames[i]].push_back(row.count[i] ? json(rounded(row.sum[i] / row.count[i]))
                                                : json(nullptr));
  }
  return columns;
}

}  // namespace modslam
