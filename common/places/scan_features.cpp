// SPDX-License-Identifier: BSD-3-Clause
#include "common/places/scan_features.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

namespace modslam {
namespace {

constexpr std::size_t kBins = kPanoramaBins, kHalf = kBins / 2;
constexpr double kBin_rad = 2 * kPi / kBins;
using Points = std::array<Eigen::Vector2d, kBins>;

struct Moments {
  double mean = 0, deviation = 0;
};

template <class Values>
Moments moments_of(const Values& values) {
  double sum = 0, squares = 0;
  for (const double v : values) sum += v, squares += v * v;
  const double n = static_cast<double>(values.size()), mean = sum / n;
  return {mean, std::sqrt(std::max(0.0, squares / n - mean * mean))};
}

class Features {
 public:
  Features(const Panorama& panorama) : range_(panorama.range_m) {
    for (std::size_t k = 0; k < kBins; ++k) {
      const double bearing = kBin_rad * static_cast<double>(k);
      points_[k] = static_cast<double>(range_[k]) * Eigen::Vector2d(std::cos(bearing), std::sin(bearing));
    }
  }

  std::vector<float> all() {
    lengths();
    steps();
    nearest_two();
    polygon();
    harmonics();
    passage_through();
    narrowest();
    return std::move(out_);
  }

 private:
  void put(double value) { out_.push_back(static_cast<float>(std::isfinite(value) ? value : 0.0)); }

  /// Mean, scatter and quantiles of the ranges, and how many are short or long.
  void lengths() {
    const Moments m = moments_of(range_);
    put(m.mean);
    put(m.deviation);
    put(m.deviation / std::max(0.05, m.mean));
    std::array<float, kBins> sorted = range_;
    std::sort(sorted.begin(), sorted.end());
    for (const double q : {0.02, 0.1, 0.25, 0.5, 0.75, 0.9}) put(sorted[static_cast<std::size_t>(q * kBins)]);
    for (const float limit_m : {1.0f, 2.0f, 4.0f, 8.0f, 14.0f})
      put(static_cast<double>(std::lower_bound(sorted.begin(), sorted.end(), limit_m) - sorted.begin()) / kBins);
  }

  /// Differences of neighbouring ranges, with and without a bound on the ranges; gaps of several sizes.
  void steps() {
    for (const double bound_m : {kPanoramaReach_m, 3.0}) {
      std::array<double, kBins> step;
      for (std::size_t k = 0; k < kBins; ++k)
        step[k] = std::abs(std::min<double>(range_[(k + 1) % kBins], bound_m) - std::min<double>(range_[k], bound_m));
      const Moments m = moments_of(step);
      put(m.mean);
      put(m.deviation);
    }
    for (const double gap_m : {0.4, 1.0, 2.0}) {
      int gaps = 0;
      for (std::size_t k = 0; k < kBins; ++k) gaps += std::abs(range_[(k + 1) % kBins] - range_[k]) > gap_m;
      put(gaps);
    }
    int relative = 0;
    for (std::size_t k = 0; k < kBins; ++k) {
      const double a = std::max(0.05f, range_[k]), b = std::max(0.05f, range_[(k + 1) % kBins]);
      relative += std::max(a / b, b / a) > 1.4;
    }
    put(relative);
  }

  /// The two nearest places where the range is smallest round about: how far they are, the angle and the way between them.
  void nearest_two() {
    constexpr std::size_t kAround = 10, kApart = 40;
    std::vector<std::size_t> minima;
    for (std::size_t k = 0; k < kBins; ++k) {
      bool least = true;
      for (std::size_t j = 1; j <= kAround && least; ++j)
        least = range_[k] <= range_[(k + j) % kBins] && range_[k] < range_[(k + kBins - j) % kBins];
      if (least) minima.push_back(k);
    }
    std::stable_sort(minima.begin(), minima.end(), [this](std::size_t a, std::size_t b) { return range_[a] < range_[b]; });
    const std::size_t first = minima.empty() ? 0 : minima[0];
    std::size_t second = (first + kHalf) % kBins;
    for (const std::size_t k : minima) {
      const std::size_t turn = (k + kBins - first) % kBins;
      if (std::min(turn, kBins - turn) < kApart) continue;
      second = k;
      break;
    }
    const std::size_t turn = (second + kBins - first) % kBins;
    put(range_[first]);
    put(range_[second]);
    put(kBin_rad * static_cast<double>(std::min(turn, kBins - turn)));
    put((points_[first] - points_[second]).norm());
    put(static_cast<double>(minima.size()));
  }

  /// Area, outline, centroid, second moments and roundness of the polygon.
  void polygon() {
    double area = 0, way = 0, xx = 0, xy = 0, yy = 0;
    Eigen::Vector2d centroid = Eigen::Vector2d::Zero();
    for (std::size_t k = 0; k < kBins; ++k) {
      const Eigen::Vector2d &p = points_[k], &q = points_[(k + 1) % kBins];
      const double cross = p.x() * q.y() - p.y() * q.x();
      area += cross / 2;
      centroid += cross / 6 * (p + q);
      xx += cross / 12 * (p.x() * p.x() + p.x() * q.x() + q.x() * q.x());
      yy += cross / 12 * (p.y() * p.y() + p.y() * q.y() + q.y() * q.y());
      xy += cross / 24 * (2 * p.x() * p.y() + p.x() * q.y() + q.x() * p.y() + 2 * q.x() * q.y());
      way += (p - q).norm();
    }
    area = std::max(area, 1e-4);
    centroid /= area;
    xx = xx / area - centroid.x() * centroid.x();
    yy = yy / area - centroid.y() * centroid.y();
    xy = xy / area - centroid.x() * centroid.y();
    const double middle = (xx + yy) / 2, spread = std::hypot((xx - yy) / 2, xy);
    const double major = std::sqrt(std::max(0.0, middle + spread)), minor = std::sqrt(std::max(0.0, middle - spread));
    std::array<double, kBins> from_centroid;
    for (std::size_t k = 0; k < kBins; ++k) from_centroid[k] = (points_[k] - centroid).norm();
    const Moments m = moments_of(from_centroid);
    const double farthest = *std::max_element(from_centroid.begin(), from_centroid.end());
    put(area);
    put(way);
    put(area / std::max(way, 1e-3));
    put(4 * kPi * area / std::max(way * way, 1e-6));
    put(centroid.norm());
    put(major);
    put(minor);
    put(minor / std::max(major, 1e-3));
    put(m.mean);
    put(m.deviation);
    put(m.mean / std::max(farthest, 1e-3));
    put(m.deviation / std::max(m.mean, 1e-3));
  }

  /// Strength of the first harmonics of the ranges around the circle, over their mean.
  void harmonics() {
    constexpr int kHarmonics = 6;
    double mean = 0;
    for (const float r : range_) mean += r;
    for (int h = 1; h <= kHarmonics; ++h) {
      std::complex<double> sum = 0;
      for (std::size_t k = 0; k < kBins; ++k) sum += static_cast<double>(range_[k]) * std::polar(1.0, -h * kBin_rad * static_cast<double>(k));
      put(2 * std::abs(sum) / std::max(mean, 1e-3));
    }
  }

  /// Straight lines through the place from wall to wall: the shortest, the longest, and how far one sees square to the shortest.
  void passage_through() {
    std::array<double, kHalf> width;
    for (std::size_t k = 0; k < kHalf; ++k) width[k] = range_[k] + range_[k + kHalf];
    const auto [least, most] = std::minmax_element(width.begin(), width.end());
    const auto across = static_cast<std::size_t>(least - width.begin());
    const std::size_t along = (across + kHalf / 2) % kHalf;
    put(*least);
    put(*most);
    put(*least / std::max(*most, 1e-3));
    put(width[along]);
    put(std::min(range_[along], range_[along + kHalf]));
    put(std::max(range_[along], range_[along + kHalf]));
    const double bearing = kBin_rad * static_cast<double>(along);
    put_widths(Eigen::Vector2d::Zero(), {std::cos(bearing), std::sin(bearing)});
  }

  /// Of two points seen on different sides, the ones closest together: between the jambs when one stands in a door.
  void narrowest() {
    constexpr std::size_t kStride = 3, kLeast = 100;  // degrees
    double least = 1e9;
    std::size_t from = 0, to = kHalf;
    for (std::size_t i = 0; i < kBins; i += kStride)
      for (std::size_t turn = kLeast; turn <= kHalf; turn += kStride) {
        const std::size_t j = (i + turn) % kBins;
        const double apart = (points_[i] - points_[j]).squaredNorm();
        if (apart >= least) continue;
        least = apart;
        from = i, to = j;
      }
    const Eigen::Vector2d a = points_[from], b = points_[to], u = (b - a) / std::max((b - a).norm(), 1e-3);
    const double foot = std::clamp(-a.dot(u), 0.0, (b - a).norm());
    put((b - a).norm());
    put((a + foot * u).norm());
    put(0.5 * (a + b).norm());
    put_widths(0.5 * (a + b), {-u.y(), u.x()});
  }

  /// Free width across a way through `middle`, some distances before and behind; of each two the smaller first.
  void put_widths(const Eigen::Vector2d& middle, const Eigen::Vector2d& along) {
    constexpr std::array<double, 5> kAhead_m = {0.4, 0.9, 1.6, 2.6, 4.5};
    constexpr double kSlice_m = 0.2, kMost_m = 6;
    const Eigen::Vector2d across(-along.y(), along.x());
    std::array<double, 2 * kAhead_m.size()> left, right;
    left.fill(kMost_m);
    right.fill(kMost_m);
    for (const Eigen::Vector2d& p : points_) {
      const double s = along.dot(p - middle), t = across.dot(p - middle);
      if (std::abs(s) > kAhead_m.back() + kSlice_m) continue;
      for (std::size_t n = 0; n < left.size(); ++n) {
        const double at = n % 2 ? -kAhead_m[n / 2] : kAhead_m[n / 2];
        if (std::abs(s - at) > kSlice_m) continue;
        double& side = t > 0 ? left[n] : right[n];
        side = std::min(side, std::abs(t));
      }
    }
    for (std::size_t n = 0; n < left.size(); n += 2) {
      const double one = left[n] + right[n], other = left[n + 1] + right[n + 1];
      put(std::min(one, other));
      put(std::max(one, other));
    }
  }

  const std::array<float, kBins>& range_;
  Points points_;
  std::vector<float> out_;
};

}  // namespace

std::vector<float> place_features(const Panorama& panorama) { return Features(panorama).all(); }

}  // namespace modslam
