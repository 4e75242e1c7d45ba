// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/hough.hpp"

#include <algorithm>
#include <cmath>

namespace modslam {
namespace {

constexpr double kNarrowest_m = 0.55;  // a gap this wide may be a door, however the beams lie

struct Line {
  Eigen::Vector2d centre, direction;
  double sigma_m;
};

/// The unit vector at half the angle of (x, y), whose length is `length`; to the right or up. Without trigonometry: many lines are fitted.
Eigen::Vector2d half_way(double x, double y, double length) {
  if (length <= 0) return {1, 0};
  if (x >= 0) {
    const double cosine = std::sqrt(0.5 * (1 + x / length));
    return {cosine, 0.5 * y / length / cosine};
  }
  const double sine = std::copysign(std::sqrt(0.5 * (1 - x / length)), y);
  return {0.5 * y / length / sine, sine};
}

Line fit(const std::vector<ScanPoint>& points, const std::vector<int>& members) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const int k : members) mean += points[static_cast<std::size_t>(k)].p;
  mean /= static_cast<double>(members.size());
  double xx = 0, xy = 0, yy = 0;
  for (const int k : members) {
    const Eigen::Vector2d d = points[static_cast<std::size_t>(k)].p - mean;
    xx += d.x() * d.x();
    xy += d.x() * d.y();
    yy += d.y() * d.y();
  }
  const double half = 0.5 * (xx - yy), spread = std::sqrt(half * half + xy * xy);
  const double across2 = std::max(0.0, 0.5 * (xx + yy) - spread);
  return {mean, half_way(half, xy, spread), std::sqrt(across2 / static_cast<double>(members.size()))};
}

/// Of the points still free, those near a line.
std::vector<int> members_of(const std::vector<ScanPoint>& points, const std::vector<int>& free, const Eigen::Vector2d& normal, double distance_m, double thickness_m) {
  std::vector<int> members;
  members.reserve(free.size());
  for (const int k : free)
    if (std::abs(normal.dot(points[static_cast<std::size_t>(k)].p) - distance_m) < thickness_m) members.push_back(k);
  return members;
}

/// The longest run of members without a gap, in order along the line; the first of those as long.
std::vector<int> longest_run(const std::vector<ScanPoint>& points, const std::vector<int>& members, const Line& line, double radstep, const HoughOptions& options) {
  struct Place {
    double along;
    int point;
  };
  std::vector<Place> places;
  places.reserve(members.size());
  for (const int k : members) places.push_back({line.direction.dot(points[static_cast<std::size_t>(k)].p - line.centre), k});
  const auto before = [](const Place& p, const Place& q) { return p.along < q.along; };
  if (places.front().along > places.back().along) std::reverse(places.begin(), places.end());  // most lie in order already, one way or the other
  if (!std::is_sorted(places.begin(), places.end(), before)) std::sort(places.begin(), places.end(), before);
  const auto breaks = [&](const Place& p, const Place& q) {
    const double apart = q.along - p.along;
    if (apart <= options.gap_m) return false;
    // Far beams that graze a wall lie far apart on it; neighbouring beams are connected all the same.
    const ScanPoint &last = points[static_cast<std::size_t>(p.point)], &point = points[static_cast<std::size_t>(q.point)];
    return std::abs(last.beam - point.beam) > 2 || apart > std::min(kNarrowest_m, 12 * radstep * point.range_m);
  };
  std::size_t best = 0, best_end = 0, start = 0;
  for (std::size_t k = 1; k <= places.size(); ++k) {
    if (k < places.size() && !breaks(places[k - 1], places[k])) continue;
    if (k - start > best_end - best) best = start, best_end = k;
    start = k;
  }
  std::vector<int> run;
  run.reserve(best_end - best);
  for (std::size_t k = best; k < best_end; ++k) run.push_back(places[k].point);
  return run;
}

/// Whether the points follow an arc rather than a line: a parabola over the fitted line explains their scatter, and it is steep for
/// its length (a radius of a metre or so). What bends less is a wall seen while turning.
bool is_arc(const std::vector<ScanPoint>& points, const std::vector<int>& run, const Line& line) {
  constexpr double kLeastBow_m = 0.03, kLeastBowToLength = 0.04, kSigmas = 4;
  const auto n = static_cast<double>(run.size());
  const auto offset = [&](int k) { return Eigen::Vector2d(points[static_cast<std::size_t>(k)].p - line.centre); };
  const double low = line.direction.dot(offset(run.front())), high = line.direction.dot(offset(run.back()));
  const double middle = 0.5 * (low + high), half = 0.5 * (high - low);
  const auto t_squared = [&](int k) {
    const double t = (line.direction.dot(offset(k)) - middle) / half;
    return t * t;
  };
  double mean = 0, qq = 0, rq = 0, rr = 0;
  for (const int k : run) mean += t_squared(k) / n;
  for (const int k : run) {
    const double q = t_squared(k) - mean, r = line.direction.x() * offset(k).y() - line.direction.y() * offset(k).x();
    qq += q * q;
    rq += r * q;
    rr += r * r;
  }
  if (half <= 0 || qq <= 0) return false;
  const double bow_m = std::abs(rq / qq), sigma_bow_m = std::sqrt(std::max(0.0, rr - rq * rq / qq) / n / qq);
  return bow_m > kLeastBow_m && bow_m > kLeastBowToLength * 2 * half && bow_m > kSigmas * sigma_bow_m;
}

/// Fits a line to the run, takes what lies on it, again.
std::vector<int> refitted(const std::vector<ScanPoint>& points, const std::vector<int>& free, std::vector<int> run, double radstep, const HoughOptions& options) {
  for (int refits = 0; refits < 2; ++refits) {
    const Line line = fit(points, run);
    const Eigen::Vector2d normal(-line.direction.y(), line.direction.x());
    const std::vector<int> members = members_of(points, free, normal, normal.dot(line.centre), options.thickness_m);
    if (members.empty()) break;
    run = longest_run(points, members, line, radstep, options);
  }
  return run;
}

Segment segment_of(const std::vector<ScanPoint>& points, const std::vector<int>& run, const Line& line, const Eigen::Vector2d& eye) {
  Segment segment;
  const auto along = [&](int k) { return line.direction.dot(points[static_cast<std::size_t>(k)].p - line.centre); };
  segment.a = line.centre + along(run.front()) * line.direction;
  segment.b = line.centre + along(run.back()) * line.direction;
  segment.points = static_cast<int>(run.size());
  segment.sigma_m = line.sigma_m;
  const Eigen::Vector2d d = segment.b - segment.a, to_eye = eye - segment.a;
  if (d.x() * to_eye.y() - d.y() * to_eye.x() < 0) std::swap(segment.a, segment.b);
  return segment;
}

}  // namespace

LineExtraction LineExtractor::operator()(const std::vector<ScanPoint>& points, const Eigen::Vector2d& eye, double radstep) {
  LineExtraction out;
  out.on_segment.assign(points.size(), false);
  if (static_cast<int>(points.size()) < options_.min_points) return out;
  votes_.start(points);
  for (int round = 0; round < 60; ++round) {
    const HoughVotes::Bucket bucket = votes_.fullest();
    if (bucket.votes < options_.min_points) break;
    std::vector<int> taken = members_of(points, votes_.voters(), bucket.normal, bucket.distance_m, options_.thickness_m + 0.5 * options_.cell_m);
    // The longest run is fitted on its own: other pieces of the bucket only cross the line somewhere.
    const Line through{points[static_cast<std::size_t>(taken[0])].p, {-bucket.normal.y(), bucket.normal.x()}, 0};
    std::vector<int> run = longest_run(points, taken, through, radstep, options_);
    if (static_cast<int>(run.size()) >= options_.min_points) {
      run = refitted(points, votes_.voters(), std::move(run), radstep, options_);
      const Line line = fit(points, run);
      const Segment segment = segment_of(points, run, line, eye);
      if (segment.points >= options_.min_points && segment.length_m() >= options_.min_length_m && !is_arc(points, run, line)) {
        out.segments.push_back(segment);
        for (const int k : run) out.on_segment[static_cast<std::size_t>(k)] = true;
        taken = std::move(run);
      }
    }
    votes_.take_back(taken);
  }
  return out;
}

LineExtraction extract_lines(const std::vector<ScanPoint>& points, const Eigen::Vector2d& eye, double radstep, const HoughOptions& options) {
  return LineExtractor(options)(points, eye, radstep);
}

}  // namespace modslam
