// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/cut_features.hpp"

#include <algorithm>
#include <cmath>

namespace modslam {
namespace {

using Vec = Eigen::Vector2d;

constexpr double kBeyond_m = 1.0, kHitBeyond_m = 0.6, kWay_m = 4.0, kRoomyWay_m = 2.5, kBeside_m = 0.35, kMostFlare = 4;
constexpr double kAtWall_m = 0.25, kLongWall_m = 3.0;

cv::Point cell(const Vec& p) { return {cvRound(p.x()), cvRound(p.y())}; }

/// Adds the cells between two places to a box.
void note(cv::Rect& box, const Vec& p, const Vec& q) {
  const cv::Point a = cell(p), b = cell(q);
  box |= cv::Rect(cv::Point(std::min(a.x, b.x), std::min(a.y, b.y)), cv::Point(std::max(a.x, b.x) + 1, std::max(a.y, b.y) + 1));
}

/// How well the outline goes on in line beyond one end of the cut; `out` runs away from it there.
double align(const Corner& corner, const Vec& out) { return std::max(out.dot(corner.before), out.dot(corner.after)); }

}  // namespace

CutFeatures::CutFeatures(const Floor& floor, const KnownSpace& space, const WallSet& walls)
    : floor_(floor), space_(space), walls_(walls), cell_m_(floor.resolution_m) {}

bool is_clear(const Floor& floor, const Vec& a, const Vec& b) {
  const double length = (b - a).norm();
  const int steps = std::max(2, static_cast<int>(2 * length));
  for (int k = 0; k <= steps; ++k) {
    const double s = length * k / steps;
    if (s < 1.5 || length - s < 1.5) continue;
    if (!floor.open(cell(a + (b - a) * k / steps))) return false;
  }
  return true;
}

/// Metres of not-floor in line beyond p, a cell to either side allowed.
double CutFeatures::solid_beyond_m(const Vec& p, const Vec& out, CutReads& reads) const {
  const Vec side(-out.y(), out.x());
  double last = 0, s = 1;
  for (; s * cell_m_ <= kBeyond_m; s += 0.5) {
    const Vec q = p + s * out;
    const bool solid = !is_open(q) || !is_open(q + side) || !is_open(q - side);
    if (solid) last = s;
    else if (s - last > 2) break;
  }
  for (const Vec& beside : {side, Vec(-side)}) note(reads.open, p + beside, p + s * out + beside);
  return last * cell_m_;
}

double CutFeatures::hit_share(const Vec& p, const Vec& out, CutReads& reads) const {
  int hit = 0, asked = 0;
  for (double s = 0.5; s * cell_m_ <= kHitBeyond_m; s += 1, ++asked) {
    const cv::Point c = cell(p + s * out);
    const cv::Rect all_around(c.x - 2, c.y - 2, 5, 5), around = all_around & cv::Rect({0, 0}, floor_.solid.size());
    reads.solid |= all_around;
    bool any = false;
    for (int y = around.y; y < around.br().y && !any; ++y)
      any = std::any_of(floor_.solid[y] + around.x, floor_.solid[y] + around.br().x, [](std::uint8_t v) { return v != 0; });
    hit += any;
  }
  return asked ? static_cast<double>(hit) / asked : 0;
}

CutFeatures::Side CutFeatures::look(const FloorCut& cut, const Vec& n, CutReads& reads) const {
  Side side;
  const Vec u = (cut.b - cut.a).normalized();
  for (const double t : {0.3, 0.5, 0.7}) {
    const Vec from = cut.a + t * (cut.b - cut.a);
    double s = 1;
    double clearance = 0;
    for (; s * cell_m_ <= kWay_m && is_open(from + s * n); s += 1)
      if (s * cell_m_ <= kRoomyWay_m) clearance = std::max<double>(clearance, floor_.clearance(cell(from + s * n)));
    note(reads.open, from, from + s * n);
    note(reads.clearance, from, from + std::min(s, kRoomyWay_m / cell_m_ + 1) * n);
    side.depth_m = std::max(side.depth_m, (s - 1) * cell_m_);
    side.clearance = std::max(side.clearance, clearance);
  }
  const Vec beside = cut.centre() + kBeside_m / cell_m_ * n;
  note(reads.open, beside, beside);
  if (is_open(beside)) {
    const double most = kMostFlare * cut.length();
    double width = 0;
    for (const Vec& way : {u, Vec(-u)}) {
      double s = 1;
      for (; width < most && is_open(beside + s * way); s += 1) width += 1;
      note(reads.open, beside, beside + s * way);
    }
    side.flare = std::min(kMostFlare, width / cut.length());
  }
  return side;
}

double CutFeatures::wall_at_m(const Vec& p) const {
  double longest = 0;
  for (const std::size_t k : walls_.near(p, p, kAtWall_m)) {
    const Wall& wall = walls_[k];
    if ((p.array() < wall.a.cwiseMin(wall.b).array() - kAtWall_m).any() || (p.array() > wall.a.cwiseMax(wall.b).array() + kAtWall_m).any()) continue;
    const Vec u = wall.direction();
    const double along = u.dot(p - wall.a), across = u.x() * (p - wall.a).y() - u.y() * (p - wall.a).x();
    if (std::abs(across) < kAtWall_m && along > -kAtWall_m && along < wall.length_m() + kAtWall_m) longest = std::max(longest, wall.length_m());
  }
  return std::min(longest, kLongWall_m);
}

Opening CutFeatures::measure(const FloorCut& cut, double narrowest, CutReads& reads) const {
  const Vec u = (cut.b - cut.a).normalized(), n(-u.y(), u.x());
  Opening out;
  const auto place = [&](const Vec& p) -> Vec { return space_.place(p.x() + 0.5, p.y() + 0.5); };
  out.a = place(cut.a);
  out.b = place(cut.b);
  auto& f = out.features;
  const auto pair = [&](OpeningFeature less, double p, double q) {
    f[less] = static_cast<float>(std::min(p, q));
    f[less + 1] = static_cast<float>(std::max(p, q));
  };
  const double half = 0.5 * cut.length();
  reads = {};
  const Side left = look(cut, n, reads), right = look(cut, -n, reads);
  f[kWidth] = static_cast<float>(cut.length() * cell_m_);
  pair(kSolidLess, solid_beyond_m(cut.a, -u, reads), solid_beyond_m(cut.b, u, reads));
  pair(kHitLess, hit_share(cut.a, -u, reads), hit_share(cut.b, u, reads));
  pair(kDepthLess, left.depth_m, right.depth_m);
  pair(kRoomyLess, left.clearance / half, right.clearance / half);
  pair(kClearLess, left.clearance * cell_m_, right.clearance * cell_m_);
  pair(kTurnLess, cut.first.turn_rad, cut.second.turn_rad);
  pair(kAlignLess, align(cut.first, -u), cut.to_corner ? align(cut.second, u) : std::abs(u.dot(cut.edge)));
  pair(kFlareLess, left.flare, right.flare);
  note(reads.clearance, cut.centre(), cut.centre());
  f[kMidClear] = static_cast<float>(floor_.clearance(cell(cut.centre())) / half);
  f[kLocal] = static_cast<float>(cut.length() / narrowest);
  measure_walls(out);
  return out;
}

bool CutFeatures::measure_walls(Opening& opening) const {
  const double p = wall_at_m(opening.a), q = wall_at_m(opening.b);
  const auto less = static_cast<float>(std::min(p, q)), more = static_cast<float>(std::max(p, q));
  const bool changes = opening.features[kWallLess] != less || opening.features[kWallMore] != more;
  opening.features[kWallLess] = less;
  opening.features[kWallMore] = more;
  return changes;
}

}  // namespace modslam
