// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/wall_band.hpp"

#include <algorithm>
#include <cmath>

namespace modslam {
namespace {

constexpr double kBin_m = LineSums::kBin_m;
constexpr double kNeverOutermost_m = 2;
constexpr double kLongEnough_m2 = 0.04;  // variance along it from which on the points tell a line's direction

/// To whole millimetres: a wall does not change with every scan that shows it once more.
Eigen::Vector2d to_grid(const Eigen::Vector2d& p) { return {1e-3 * std::round(1e3 * p.x()), 1e-3 * std::round(1e3 * p.y())}; }

}  // namespace

Band::Band(const WallBlocks::Index& block, const WallBlocks::LineKey& key, const LineSums& sums) {
  n_ = std::max(kPointUnit, static_cast<double>(sums.n) * kPointUnit);
  const double points = std::max<double>(1, static_cast<double>(sums.n));
  const Eigen::Vector2d offset = Eigen::Vector2d(static_cast<double>(sums.x), static_cast<double>(sums.y)) * kLengthUnit / points;
  mean_ = WallBlocks::centre(block) + offset;
  towards_ = Eigen::Vector2d(static_cast<double>(sums.ux), static_cast<double>(sums.uy)) * kLengthUnit * kPointUnit;
  Eigen::Matrix2d squares;
  squares << static_cast<double>(sums.xx), static_cast<double>(sums.xy), static_cast<double>(sums.xy), static_cast<double>(sums.yy);
  scatter_ = n_ * (squares * kLengthUnit * kLengthUnit / points - offset * offset.transpose());
  const auto seen = [](std::int32_t count) { return count > 0; };
  const auto first = std::find_if(sums.sightings.begin(), sums.sightings.end(), seen);
  const auto last = std::find_if(sums.sightings.rbegin(), sums.sightings.rend(), seen).base();
  const Eigen::Vector2d d = WallBlocks::direction(key), across(-d.y(), d.x());
  if (first < last)
    stretches_.push_back({WallBlocks::centre(block) + across.dot(offset) * across + kBin_m * static_cast<double>(first - sums.sightings.begin() - LineSums::kBins / 2) * d,
                          kBin_m * d, {first, last}});
  for (const Stretch& stretch : stretches_) ends_ = {stretch.first, stretch.first + static_cast<double>(stretch.sightings.size()) * stretch.step};
  refit();
}

void Band::refit() {
  const double angle = 0.5 * std::atan2(2 * scatter_(0, 1), scatter_(0, 0) - scatter_(1, 1));
  const double half = 0.5 * scatter_.trace(), spread = std::hypot(0.5 * (scatter_(0, 0) - scatter_(1, 1)), scatter_(0, 1));
  const bool told = (half + spread) / n_ > kLongEnough_m2;
  direction_ = told || towards_.norm() == 0 ? Eigen::Vector2d(std::cos(angle), std::sin(angle)) : Eigen::Vector2d(towards_.normalized());
  if (direction_.dot(towards_) < 0) direction_ = -direction_;
  sigma_m_ = std::sqrt(std::max(0.0, half - spread) / n_);
  along_m2_ = (half + spread) / n_;
  low_ = ends_.empty() ? 0 : 1e300;
  high_ = ends_.empty() ? 0 : -1e300;
  for (const Eigen::Vector2d& end : ends_) {
    low_ = std::min(low_, along(end));
    high_ = std::max(high_, along(end));
  }
  // However the line turns, what lies this far within stays within.
  const auto is_within = [&](const Eigen::Vector2d& end) { return along(end) > low_ + kNeverOutermost_m && along(end) < high_ - kNeverOutermost_m; };
  ends_.erase(std::remove_if(ends_.begin(), ends_.end(), is_within), ends_.end());
}

/// Of the least-squares line, at a place along it.
double Band::sigma_across_m(double along_m) const {
  return sigma_m_ * std::sqrt((1 + (along_m2_ > 0 ? along_m * along_m / along_m2_ : 0.0)) / n_);
}

bool Band::takes(const Band& other, const WallMapOptions& options) const {
  const Eigen::Vector2d a = other.low_end(), b = other.high_end();
  if (along(a) >= high_ + options.band_gap_m || along(b) <= low_ - options.band_gap_m) return false;  // most are too far
  if (std::abs(across(other.mean_)) > options.join_m) return false;
  if (std::max(std::abs(across(a)), std::abs(across(b))) > 1.6 * options.join_m) return false;
  return direction_.dot(other.direction_) >= std::cos(options.join_rad);
}

void Band::absorb(const Band& other) {
  const Eigen::Vector2d apart = other.mean_ - mean_;
  const double n = n_ + other.n_;
  scatter_ += other.scatter_ + n_ * other.n_ / n * apart * apart.transpose();
  mean_ += other.n_ / n * apart;
  towards_ += other.towards_;
  n_ = n;
  stretches_.insert(stretches_.end(), other.stretches_.begin(), other.stretches_.end());
  ends_.insert(ends_.end(), other.ends_.begin(), other.ends_.end());
  refit();
}

WallBand Band::walls(const WallMapOptions& options, const std::function<bool(const Eigen::Vector2d&)>& is_solid) const {
  std::vector<std::int32_t> sightings(static_cast<std::size_t>(std::max(0.0, length_m() / kBin_m)) + 1, 0);
  for (const Stretch& stretch : stretches_) {
    const double first = (along(stretch.first + 0.5 * stretch.step) - low_) / kBin_m;
    for (std::size_t k = 0; k < stretch.sightings.size(); ++k) {
      const auto bin = static_cast<std::int64_t>(first) + static_cast<std::int64_t>(k);
      sightings[static_cast<std::size_t>(std::clamp<std::int64_t>(bin, 0, static_cast<std::int64_t>(sightings.size()) - 1))] += stretch.sightings[k];
    }
  }
  WallBand band;
  double start = 0, end = -1e300;
  const auto close = [&] {
    if (end - start < options.min_length_m) return;
    Wall wall;
    wall.a = to_grid(mean_ + start * direction_);
    wall.b = to_grid(mean_ + end * direction_);
    wall.sigma_m = sigma_m_;
    wall.at_a.across_m = sigma_across_m(start);
    wall.at_b.across_m = sigma_across_m(end);
    band.walls.push_back(wall);
  };
  for (std::size_t k = 0; k < sightings.size(); ++k) {
    if (sightings[k] < options.min_sightings) continue;
    const double at = low_ + static_cast<double>(k) * kBin_m;
    if (!is_solid(mean_ + (at + 0.5 * kBin_m) * direction_)) continue;
    if (at - end > options.bridge_m) {
      close();
      start = at;
    }
    end = at + kBin_m;
  }
  close();
  return band;
}

}  // namespace modslam
