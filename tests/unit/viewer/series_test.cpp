// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/series.hpp"

#include <catch2/catch.hpp>

namespace modslam {
namespace {

TEST_CASE("figures are means over half seconds, null where nothing was said") {
  Series series;
  series.add(10'000'000, Series::kError_m, 0.1);
  series.add(10'100'000, Series::kError_m, 0.3);
  series.add(10'600'000, Series::kOk, 1);
  const auto json = series.to_json();
  REQUIRE(json["t"].size() == 2);
  CHECK(json["begin_utime"] == 10'000'000);
  CHECK(json["error_m"][0] == 0.2);
  CHECK(json["error_m"][1].is_null());
  CHECK(json["ok"][1] == 1.0);
}

TEST_CASE("a long run keeps its length and its mean in a bounded number of rows") {
  Series series;
  double sum = 0;
  const int n = 10'000;
  for (int i = 0; i < n; ++i) {
    series.add(1'000'000 + i * 500'000LL, Series::kSigma_m, i % 7);
    sum += i % 7;
  }
  REQUIRE(series.rows() <= Series::kMaxRows);
  const auto json = series.to_json();
  CHECK(json["t"].back().get<double>() == Approx(5000).margin(series.interval_s()));
  double mean = 0;
  for (const auto& v : json["sigma_m"])
    mean += v.get<double>() / static_cast<double>(json["t"].size());
  CHECK(mean == Approx(sum / n).margin(0.05));
}

TEST_CASE("a stamp that steps back makes no row, a value that is no number none either") {
  Series series;
  series.add(10'000'000, Series::kOk, 1);
  series.add(1'000'000, Series::kOk, 0);
  series.add(90'000'000, Series::kOk, std::numeric_limits<double>::quiet_NaN());
  CHECK(series.rows() == 1);
  CHECK(series.to_json()["ok"][0] == 0.5);
}

}  // namespace
}  // namespace modslam
