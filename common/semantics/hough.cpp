// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/hough.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/core/hal/intrin.hpp>

namespace modslam {
namespace {

constexpr double kNarrowest_m = 0.55;  // a gap this wide may be a door, however the beams lie

struct Line {
  Eigen::Vector2d centre, direction;
  double sigma_m;
};

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
  const double angle_rad = 0.5 * std::atan2(2 * xy, xx - yy);
  const double across2 = std::max(0.0, 0.5 * (xx + yy) - std::hypot(0.5 * (xx - yy), xy));
  return {mean, {std::cos(angle_rad), std::sin(angle_rad)}, std::sqrt(across2 / static_cast<double>(members.size()))};
}

std::int16_t largest(const std::int16_t* values, int count) {
  cv::v_int16x8 most = cv::v_setall_s16(0);
  int k = 0;
  for (; k + 8 <= count; k += 8) most = cv::v_max(most, cv::v_load(values + k));
  std::int16_t out = cv::v_reduce_max(most);
  for (; k < count; ++k) out = std::max(out, values[k]);
  return out;
}

/// Votes of the points still free: buckets over (angle, distance to the first point).
class Accumulator {
 public:
  Accumulator(const std::vector<ScanPoint>& points, const HoughOptions& options) : options_(options) {
    double reach = 0;
    origin_ = points.front().p;
    for (const ScanPoint& point : points) reach = std::max(reach, (point.p - origin_).norm());
    angles_ = static_cast<int>(std::lround(kPi / options.cell_rad));
    half_ = static_cast<int>(reach / options.cell_m) + 2;
    votes_ = cv::Mat1s(angles_, 2 * half_ + 1, std::int16_t{0});
    normals_.resize(2, angles_);
    rows_.resize(angles_);
    for (int k = 0; k < angles_; ++k) {
      const double angle = k * kPi / angles_;
      normals_.col(k) = Eigen::Vector2d(std::cos(angle), std::sin(angle)).cast<float>();
      rows_(k) = k * votes_.cols;
    }
    x_ = normals_.row(0).transpose();
    y_ = normals_.row(1).transpose();
    for (const ScanPoint& point : points) vote(point.p, 1);
    most_ = Eigen::ArrayXi::Constant(angles_, static_cast<int>(points.size()));
  }
  void take_back(const Eigen::Vector2d& p) { vote(p, -1); }

  /// Fullest bucket. @return its votes.
  int fullest(Eigen::Vector2d& normal, double& distance) {
    // Votes only go: what was the most of an angle bounds it, and few angles need another look.
    for (;;) {
      int angle = 0;
      const int bound = most_.maxCoeff(&angle);
      const std::int16_t* row = votes_[angle];
      most_(angle) = largest(row, votes_.cols);
      if (most_(angle) < bound) continue;
      const auto at = std::find(row, row + votes_.cols, static_cast<std::int16_t>(bound)) - row;
      normal = normals_.col(angle).cast<double>();
      distance = (static_cast<double>(at) - half_ + 0.5) * options_.cell_m + normal.dot(origin_);
      return bound;
    }
  }

 private:
  void vote(const Eigen::Vector2d& p, int weight) {
    const Eigen::Vector2f q = ((p - origin_) / options_.cell_m).cast<float>();
    buckets_ = (x_ * q.x() + y_ * q.y() + static_cast<float>(half_)).cast<int>() + rows_;
    std::int16_t* votes = votes_[0];
    for (int k = 0; k < angles_; ++k) votes[buckets_(k)] = static_cast<std::int16_t>(votes[buckets_(k)] + weight);
  }
  HoughOptions options_;
  Eigen::Vector2d origin_;
  int angles_ = 0, half_ = 0;
  Eigen::Matrix2Xf normals_;
  Eigen::ArrayXf x_, y_;       ///< of the normals
  Eigen::ArrayXi rows_, buckets_;
  cv::Mat1s votes_;
  Eigen::ArrayXi most_;  ///< of each angle, at most
};

/// Runs of members without a gap, in order along the line.
std::vector<std::vector<int>> split_at_gaps(const std::vector<ScanPoint>& points, std::vector<int> members, const Line& line,
                                            double radstep, const HoughOptions& options) {
  const auto along = [&](int k) { return line.direction.dot(points[static_cast<std::size_t>(k)].p - line.centre); };
  std::sort(members.begin(), members.end(), [&](int a, int b) { return along(a) < along(b); });
  std::vector<std::vector<int>> runs;
  for (const int k : members) {
    bool starts = runs.empty();
    if (!starts) {
      const ScanPoint &last = points[static_cast<std::size_t>(runs.back().back())], &point = points[static_cast<std::size_t>(k)];
      // Far beams that graze a wall lie far apart on it; neighbouring beams are connected all the same.
      const bool neighbours = std::abs(last.beam - point.beam) <= 2;
      const double reach = std::max(options.gap_m, neighbours ? std::min(kNarrowest_m, 12 * radstep * point.range_m) : 0.0);
      starts = along(k) - along(runs.back().back()) > reach;
    }
    if (starts) runs.emplace_back();
    runs.back().push_back(k);
  }
  return runs;
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

}  // namespace

LineExtraction extract_lines(const std::vector<ScanPoint>& points, const Eigen::Vector2d& eye, double radstep,
                             const HoughOptions& options) {
  LineExtraction out;
  out.on_segment.assign(points.size(), false);
  if (static_cast<int>(points.size()) < options.min_points) return out;
  Accumulator votes(points, options);
  std::vector<bool> used(points.size(), false);

  const auto members_of = [&](const Eigen::Vector2d& normal, double distance, double thickness_m) {
    std::vector<int> members;
    for (std::size_t k = 0; k < points.size(); ++k)
      if (!used[k] && std::abs(normal.dot(points[k].p) - distance) < thickness_m) members.push_back(static_cast<int>(k));
    return members;
  };
  for (int round = 0; round < 60; ++round) {
    Eigen::Vector2d normal;
    double distance = 0;
    if (votes.fullest(normal, distance) < options.min_points) break;
    std::vector<int> members = members_of(normal, distance, options.thickness_m + 0.5 * options.cell_m);
    std::vector<int> taken = members;
    // The longest run is fitted on its own: other pieces of the bucket only cross the line somewhere.
    auto runs = split_at_gaps(points, members, {points[static_cast<std::size_t>(members[0])].p, {-normal.y(), normal.x()}, 0}, radstep, options);
    std::stable_sort(runs.begin(), runs.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
    if (static_cast<int>(runs[0].size()) >= options.min_points) {
      for (int refits = 0; refits < 2; ++refits) {
        const Line line = fit(points, runs[0]);
        const Eigen::Vector2d n(-line.direction.y(), line.direction.x());
        members = members_of(n, n.dot(line.centre), options.thickness_m);
        if (members.empty()) break;
        auto again = split_at_gaps(points, members, line, radstep, options);
        std::stable_sort(again.begin(), again.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
        runs[0] = again[0];
      }
      const Line line = fit(points, runs[0]);
      Segment segment;
      const auto along = [&](int k) { return line.direction.dot(points[static_cast<std::size_t>(k)].p - line.centre); };
      segment.a = line.centre + along(runs[0].front()) * line.direction;
      segment.b = line.centre + along(runs[0].back()) * line.direction;
      segment.points = static_cast<int>(runs[0].size());
      segment.sigma_m = line.sigma_m;
      const Eigen::Vector2d d = segment.b - segment.a, to_eye = eye - segment.a;
      if (d.x() * to_eye.y() - d.y() * to_eye.x() < 0) std::swap(segment.a, segment.b);
      if (segment.points >= options.min_points && segment.length_m() >= options.min_length_m && !is_arc(points, runs[0], line)) {
        out.segments.push_back(segment);
        for (const int k : runs[0]) out.on_segment[static_cast<std::size_t>(k)] = true;
        taken = runs[0];
      }
    }
    for (const int k : taken)
      if (!used[static_cast<std::size_t>(k)]) {
        used[static_cast<std::size_t>(k)] = true;
        votes.take_back(points[static_cast<std::size_t>(k)].p);
      }
  }
  return out;
}

}  // namespace modslam
