// SPDX-License-Identifier: BSD-3-Clause
/// @file Figures of a set of errors.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

namespace modslam {

/// All zero for no values: look at count first.
struct Statistics {
  std::size_t count = 0;
  double mean = 0, std = 0, rms = 0, median = 0, p95 = 0, max = 0;  ///< std over the population
};

inline Statistics statistics_of(std::vector<double> values) {
  Statistics s;
  s.count = values.size();
  if (values.empty()) return s;
  std::sort(values.begin(), values.end());
  const double n = static_cast<double>(values.size());
  double sum = 0, squares = 0, deviations = 0;
  for (const double v : values) sum += v, squares += v * v;
  s.mean = sum / n;
  for (const double v : values) deviations += (v - s.mean) * (v - s.mean);
  s.std = std::sqrt(deviations / n);
  s.rms = std::sqrt(squares / n);
  const std::size_t middle = values.size() / 2;
  s.median = values.size() % 2 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
  s.p95 = values[static_cast<std::size_t>(0.95 * (n - 1) + 0.5)];
  s.max = values.back();
  return s;
}

}  // namespace modslam
