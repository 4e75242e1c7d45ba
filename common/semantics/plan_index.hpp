// SPDX-License-Identifier: BSD-3-Clause
/// @file Things of a plan by the squares that the boxes around them reach into, so that one looks only at what is near.
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

namespace modslam {

class PlanIndex {
 public:
  explicit PlanIndex(double square_m) : square_m_(square_m) {}

  /// A thing whose box has p and q among its corners.
  void add(const Eigen::Vector2d& p, const Eigen::Vector2d& q, std::size_t number) {
    each_square(p, q, 0, [&](std::int64_t key) { squares_[key].push_back(number); });
  }
  /// Undoes add() with the same arguments.
  void remove(const Eigen::Vector2d& p, const Eigen::Vector2d& q, std::size_t number) {
    each_square(p, q, 0, [&](std::int64_t key) { take_out(key, number); });
  }

  /// A straight line from a to b: it is in the squares that it runs through, not in all of its box.
  void add_line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, std::size_t number) {
    each_square_on(a, b, [&](std::int64_t key) { squares_[key].push_back(number); });
  }
  /// Undoes add_line() with the same arguments.
  void remove_line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, std::size_t number) {
    each_square_on(a, b, [&](std::int64_t key) { take_out(key, number); });
  }

  /// Visits the numbers of all things that may lie within `margin_m` of the box, in no order, some more than once.
  template <class Visit>
  void each_near(const Eigen::Vector2d& p, const Eigen::Vector2d& q, double margin_m, Visit visit) const {
    each_square(p, q, margin_m, [&](std::int64_t key) {
      const auto square = squares_.find(key);
      if (square == squares_.end()) return;
      for (const std::size_t number : square->second) visit(number);
    });
  }

  /// Numbers of all things that may lie within `margin_m` of the box, lowest first.
  std::vector<std::size_t> near(const Eigen::Vector2d& p, const Eigen::Vector2d& q, double margin_m) const {
    std::vector<std::size_t> found;
    each_near(p, q, margin_m, [&](std::size_t number) { found.push_back(number); });
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

 private:
  std::int64_t index(double x) const { return static_cast<std::int64_t>(std::floor(std::clamp(x, -1e6, 1e6) / square_m_)); }
  static std::int64_t key_of(std::int64_t x, std::int64_t y) { return x * (std::int64_t{1} << 32) + y; }

  void take_out(std::int64_t key, std::size_t number) {
    const auto square = squares_.find(key);
    if (square == squares_.end()) return;
    std::vector<std::size_t>& here = square->second;
    here.erase(std::remove(here.begin(), here.end(), number), here.end());
    if (here.empty()) squares_.erase(square);
  }

  /// Row by row; a hair more than what the line crosses.
  template <class Visit>
  void each_square_on(const Eigen::Vector2d& a, const Eigen::Vector2d& b, Visit visit) const {
    constexpr double kHair_m = 1e-6;
    const Eigen::Vector2d &low = a.y() < b.y() ? a : b, &high = a.y() < b.y() ? b : a, d = high - low;
    for (std::int64_t y = index(low.y() - kHair_m); y <= index(high.y() + kHair_m); ++y) {
      const auto x_at = [&](double row) { return d.y() > kHair_m ? low.x() + std::clamp((row - low.y()) / d.y(), 0.0, 1.0) * d.x() : low.x(); };
      double from = x_at(static_cast<double>(y) * square_m_ - kHair_m), to = x_at(static_cast<double>(y + 1) * square_m_ + kHair_m);
      if (d.y() <= kHair_m) to = high.x();
      if (from > to) std::swap(from, to);
      for (std::int64_t x = index(from - kHair_m); x <= index(to + kHair_m); ++x) visit(key_of(x, y));
    }
  }

  template <class Visit>
  void each_square(const Eigen::Vector2d& p, const Eigen::Vector2d& q, double margin_m, Visit visit) const {
    const Eigen::Vector2d low = p.cwiseMin(q).array() - margin_m, high = p.cwiseMax(q).array() + margin_m;
    for (std::int64_t y = index(low.y()); y <= index(high.y()); ++y)
      for (std::int64_t x = index(low.x()); x <= index(high.x()); ++x) visit(key_of(x, y));
  }

  double square_m_;
  std::unordered_map<std::int64_t, std::vector<std::size_t>> squares_;
};

}  // namespace modslam
