// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/wall_map.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/pose2.hpp"

namespace modslam {
namespace {

constexpr double kBin_m = 0.05;
constexpr int kAngleBins = 72;

/// Segments of one line: sums for its least-squares line, and the segments themselves for their places along it.
class Band {
 public:
  explicit Band(const Segment& first) {
    direction_ = (first.b - first.a).normalized();
    add(first);
  }

  void add(const Segment& s) {
    // A segment of n even points between a and b with scatter sigma: its sums in closed form.
    const double n = s.points;
    const Eigen::Vector2d mid = 0.5 * (s.a + s.b), half = 0.5 * (s.b - s.a);
    n_ += n;
    sum_ += n * mid;
    squares_ += n * (mid * mid.transpose() + half * half.transpose() / 3.0 + s.sigma_m * s.sigma_m / 2 * Eigen::Matrix2d::Identity());
    segments_.push_back(s);
    refit();
    const double a = along(s.a), b = along(s.b);
    low_ = segments_.size() == 1 ? std::min(a, b) : std::min({low_, a, b});
    high_ = segments_.size() == 1 ? std::max(a, b) : std::max({high_, a, b});
  }

  bool takes(const Segment& s, const WallMapOptions& options) const {
    const Eigen::Vector2d u = (s.b - s.a).normalized();
    if (u.dot(direction_) < std::cos(options.join_rad)) return false;
    const Eigen::Vector2d mid = 0.5 * (s.a + s.b);
    if (std::abs(across(mid)) > options.join_m) return false;
    if (std::max(std::abs(across(s.a)), std::abs(across(s.b))) > 1.6 * options.join_m) return false;
    const double a = along(s.a), b = along(s.b);
    return std::min(a, b) < high_ + options.band_gap_m && std::max(a, b) > low_ - options.band_gap_m;
  }

  /// Whether `other` has grown onto this one's line.
  bool meets(const Band& other, const WallMapOptions& options) const {
    if (direction_.dot(other.direction_) < std::cos(options.join_rad)) return false;
    const Eigen::Vector2d a = other.centre_ + other.low_ * other.direction_, b = other.centre_ + other.high_ * other.direction_;
    if (std::max(std::abs(across(a)), std::abs(across(b))) > options.join_m) return false;
    return along(a) < high_ + options.band_gap_m && along(b) > low_ - options.band_gap_m;
  }

  void absorb(const Band& other) {
    for (const Segment& s : other.segments_) add(s);
  }

  WallBand walls(const WallMapOptions& options, const std::function<bool(const Eigen::Vector2d&)>& is_solid) const {
    double low = 1e300, high = -1e300;
    for (const Segment& s : segments_) {
      low = std::min({low, along(s.a), along(s.b)});
      high = std::max({high, along(s.a), along(s.b)});
    }
    std::vector<int> sightings(static_cast<std::size_t>((high - low) / kBin_m) + 1, 0);
    for (const Segment& s : segments_) {
      const auto from = static_cast<std::size_t>((std::min(along(s.a), along(s.b)) - low) / kBin_m);
      const auto to = static_cast<std::size_t>((std::max(along(s.a), along(s.b)) - low) / kBin_m);
      for (std::size_t k = from; k <= to && k < sightings.size(); ++k) ++sightings[k];
    }
    WallBand band;
    double start = 0, end = -1e300;
    const auto close = [&] {
      if (end - start < options.min_length_m) return;
      Wall wall;
      wall.a = centre_ + start * direction_;
      wall.b = centre_ + end * direction_;
      wall.sigma_m = sigma_m_;
      band.walls.push_back(wall);
    };
    for (std::size_t k = 0; k < sightings.size(); ++k) {
      if (sightings[k] < options.min_sightings) continue;
      const double at = low + static_cast<double>(k) * kBin_m;
      if (!is_solid(centre_ + (at + 0.5 * kBin_m) * direction_)) continue;
      if (at - end > options.bridge_m) {
        close();
        start = at;
      }
      end = at + kBin_m;
    }
    close();
    return band;
  }

  int angle_bin() const { return bin_of(direction_); }
  static int bin_of(const Eigen::Vector2d& u) {
    return static_cast<int>((std::atan2(u.y(), u.x()) + kPi) / (2 * kPi) * kAngleBins) % kAngleBins;
  }

 private:
  double along(const Eigen::Vector2d& p) const { return direction_.dot(p - centre_); }
  double across(const Eigen::Vector2d& p) const {
    return direction_.x() * (p.y() - centre_.y()) - direction_.y() * (p.x() - centre_.x());
  }
  void refit() {
    const Eigen::Vector2d mean = sum_ / n_;
    const Eigen::Matrix2d S = squares_ / n_ - mean * mean.transpose();
    const double angle = 0.5 * std::atan2(2 * S(0, 1), S(0, 0) - S(1, 1));
    Eigen::Vector2d u(std::cos(angle), std::sin(angle));
    if (u.dot(direction_) < 0) u = -u;
    sigma_m_ = std::sqrt(std::max(0.0, 0.5 * S.trace() - std::hypot(0.5 * (S(0, 0) - S(1, 1)), S(0, 1))));
    // The extent is kept in the new line's coordinates; it turns by very little.
    const double shift = u.dot(centre_ - mean);
    low_ += shift;
    high_ += shift;
    centre_ = mean;
    direction_ = u;
  }

  double n_ = 0, low_ = 0, high_ = 0, sigma_m_ = 0;
  Eigen::Vector2d sum_ = Eigen::Vector2d::Zero(), centre_ = Eigen::Vector2d::Zero(), direction_;
  Eigen::Matrix2d squares_ = Eigen::Matrix2d::Zero();
  std::vector<Segment> segments_;
};

/// Bands that began far apart on one line grow towards each other; here they become one, or the doors between them are never looked for and
/// the sightings of a wall are split between two.
void join_bands(std::vector<Band>& bands, const WallMapOptions& options) {
  for (std::size_t i = 0; i < bands.size(); ++i)
    for (std::size_t j = i + 1; j < bands.size();) {
      if (!bands[i].meets(bands[j], options)) {
        ++j;
        continue;
      }
      bands[i].absorb(bands[j]);
      bands.erase(bands.begin() + static_cast<std::ptrdiff_t>(j));
      j = i + 1;  // the longer band may reach others now
    }
}

}  // namespace

std::vector<WallBand> merge_segments(const std::vector<PlacedSegments>& scans, const WallMapOptions& options,
                                     const std::function<bool(const Eigen::Vector2d&)>& is_solid) {
  std::vector<const Segment*> order;
  for (const PlacedSegments& scan : scans)
    for (const Segment& segment : scan) order.push_back(&segment);
  // Long segments know their line best: they found the bands.
  std::stable_sort(order.begin(), order.end(), [](const Segment* a, const Segment* b) { return a->length_m() > b->length_m(); });

  std::vector<Band> bands;
  std::vector<std::vector<std::size_t>> by_angle(kAngleBins);
  for (const Segment* segment : order) {
    const int bin = Band::bin_of(segment->b - segment->a);
    Band* home = nullptr;
    for (int d = -2; d <= 2 && !home; ++d)
      for (const std::size_t k : by_angle[static_cast<std::size_t>((bin + d + kAngleBins) % kAngleBins)])
        if (bands[k].takes(*segment, options)) {
          home = &bands[k];
          break;
        }
    if (home) {
      home->add(*segment);
    } else {
      bands.emplace_back(*segment);
      by_angle[static_cast<std::size_t>(bands.back().angle_bin())].push_back(bands.size() - 1);
    }
  }
  join_bands(bands, options);
  std::vector<WallBand> out;
  for (const Band& band : bands) {
    WallBand walls = band.walls(options, is_solid);
    if (!walls.walls.empty()) out.push_back(std::move(walls));
  }
  return out;
}

}  // namespace modslam
