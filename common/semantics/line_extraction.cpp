// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/line_extraction.hpp"

#include <algorithm>
#include <cmath>

namespace modslam {
namespace {

constexpr int kAngleBuckets = 60;  // 3 degrees each
constexpr int kNeighbours = 12;    // beams on either side of a seed that vote

/// Moments of points, from which a line is fitted in closed form.
struct Moments {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  void add(const Eigen::Vector2d& p, double w) {
    n += w;
    x += w * p.x();
    y += w * p.y();
    xx += w * p.x() * p.x();
    xy += w * p.x() * p.y();
    yy += w * p.y() * p.y();
  }
  FittedLine line() const {
    const double mx = x / n, my = y / n;
    const double cxx = xx / n - mx * mx, cxy = xy / n - mx * my, cyy = yy / n - my * my;
    const double angle = 0.5 * std::atan2(2 * cxy, cxx - cyy);
    const double smaller = 0.5 * (cxx + cyy) - std::hypot(0.5 * (cxx - cyy), cxy);
    return {{mx, my}, {std::cos(angle), std::sin(angle)}, std::sqrt(std::max(0.0, smaller))};
  }
};

class Extractor {
 public:
  Extractor(const std::vector<ScanPoint>& points, double radstep,
            const LineExtractionParameters& parameters)
      : points_(points),
        radstep_(std::abs(radstep)),
        parameters_(parameters),
        claimed_(points.size(), -1) {}

  ClassifiedScan run() {
    const int n = static_cast<int>(points_.size());
    for (const int seed : seed_order(n)) {
      if (claimed_[static_cast<std::size_t>(seed)] < 0) grow_from(seed);
    }
    ClassifiedScan out;
    for (const ScanPoint& point : points_) out.points.push_back(point.p);
    out.segment_of = std::move(claimed_);
    out.segments = std::move(segments_);
    return out;
  }

 private:
  /// Steps through the beams by a stride near the golden section: spread like random draws, yet
  /// always the same.
  static std::vector<int> seed_order(int n) {
    std::vector<int> order;
    if (n == 0) return order;
    int stride = std::max(1, static_cast<int>(0.618 * n));
    while (std::max(stride, n) > 1 && gcd(stride, n) != 1) ++stride;
    const int draws = std::max(1, n);
    for (int k = 0, at = 0; k < draws; k += 1, at = (at + stride) % n)
      if (k % 2 == 0) order.push_back(at);  // every other point: a segment has many
    return order;
  }
  static int gcd(int a, int b) { return b == 0 ? a : gcd(b, a % b); }

  const Eigen::Vector2d& at(int i) const { return points_[static_cast<std::size_t>(i)].p; }

  double allowed_gap(int i) const {
    return std::max(parameters_.max_gap_m,
                    3.0 * points_[static_cast<std::size_t>(i)].range_m * radstep_);
  }

  void grow_from(int seed) {
    Eigen::Vector2d normal;
    double offset = 0;
    if (!vote(seed, normal, offset)) return;
    int first = seed, last = seed;
    for (int pass = 0; pass < 3; ++pass) {
      Moments moments;
      const bool wide = pass == 0;
      spread(seed, normal, offset, wide ? 1.6 * parameters_.across_m : parameters_.across_m, first,
             last, moments);
      if (moments.n < 3) return;
      const FittedLine line = moments.line();
      normal = {-line.direction.y(), line.direction.x()};
      offset = normal.dot(line.centre);
    }
    claim(first, last, normal, offset);
  }

  /// The bucket (theta, r) that most neighbours of the seed agree on, r being that of the seed.
  bool vote(int seed, Eigen::Vector2d& normal, double& offset) const {
    int votes[kAngleBuckets] = {};
    const int n = static_cast<int>(points_.size());
    for (int k = 1; k <= kNeighbours; ++k) {
      for (const int other : {seed - k, seed + k}) {
        if (other < 0 || other >= n || claimed_[static_cast<std::size_t>(other)] >= 0) continue;
        const Eigen::Vector2d d = at(other) - at(seed);
        if (d.squaredNorm() < 0.0025) continue;
        double theta = std::atan2(d.y(), d.x());
        if (theta < 0) theta += kPi;
        ++votes[static_cast<int>(theta / kPi * kAngleBuckets) % kAngleBuckets];
      }
    }
    int best = 0, best_votes = 0;
    for (int b = 0; b < kAngleBuckets; ++b) {
      const int sum = votes[b] + votes[(b + 1) % kAngleBuckets] +
                      votes[(b + kAngleBuckets - 1) % kAngleBuckets];
      if (sum + votes[b] > best_votes) best = b, best_votes = sum + votes[b];
    }
    if (best_votes < 4) return false;
    const double theta = (best + 0.5) * kPi / kAngleBuckets;
    normal = {-std::sin(theta), std::cos(theta)};
    offset = normal.dot(at(seed));
    return true;
  }

  /// Walks from the seed both ways along the beams while the points stay on the line without a gap.
  void spread(int seed, const Eigen::Vector2d& normal, double offset, double across, int& first,
              int& last, Moments& moments) const {
    const int n = static_cast<int>(points_.size());
    first = last = seed;
    if (std::abs(normal.dot(at(seed)) - offset) <= across) moments.add(at(seed), 1);
    for (const int step : {-1, 1}) {
      int end = seed;
      for (int i = seed + step; i >= 0 && i < n; i += step) {
        if ((at(i) - at(end)).norm() > allowed_gap(i)) {
          if (std::abs(i - end) > 4) break;  // a few stray beams may stand in front of the line
          continue;
        }
        if (claimed_[static_cast<std::size_t>(i)] >= 0) break;
        if (std::abs(normal.dot(at(i)) - offset) > across) {
          if (std::abs(i - end) > 4) break;
          continue;
        }
        moments.add(at(i), 1);
        end = i;
      }
      (step < 0 ? first : last) = end;
    }
  }

  void claim(int first, int last, const Eigen::Vector2d& normal, double offset) {
    const Eigen::Vector2d along(normal.y(), -normal.x());
    std::vector<int> members;
    double low = 1e9, high = -1e9;
    for (int i = first; i <= last; ++i) {
      if (claimed_[static_cast<std::size_t>(i)] >= 0 ||
          std::abs(normal.dot(at(i)) - offset) > parameters_.across_m)
        continue;
      members.push_back(i);
      low = std::min(low, along.dot(at(i)));
      high = std::max(high, along.dot(at(i)));
    }
    if (static_cast<int>(members.size()) < parameters_.min_points ||
        high - low < parameters_.min_length_m)
      return;
    for (const int i : members)
      claimed_[static_cast<std::size_t>(i)] = static_cast<int>(segments_.size());
    segments_.push_back({offset * normal + low * along, offset * normal + high * along});
  }

  const std::vector<ScanPoint>& points_;
  const double radstep_;
  const LineExtractionParameters parameters_;
  std::vector<int> claimed_;
  std::vector<Segment> segments_;
};

}  // namespace

ClassifiedScan extract_lines(const std::vector<ScanPoint>& points, double radstep,
                             const LineExtractionParameters& parameters) {
  return Extractor(points, radstep, parameters).run();
}

FittedLine fit_line(const std::vector<Eigen::Vector2d>& points,
                    const std::vector<double>& weights) {
  const Eigen::Vector2d origin = points.front();  // keeps the sums small far from the map's origin
  Moments moments;
  for (std::size_t i = 0; i < points.size(); ++i) moments.add(points[i] - origin, weights[i]);
  FittedLine line = moments.line();
  line.centre += origin;
  return line;
}

}  // namespace modslam
