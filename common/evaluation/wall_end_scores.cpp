// SPDX-License-Identifier: BSD-3-Clause
#include "common/evaluation/wall_end_scores.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace modslam {
namespace {

using Vec = Eigen::Vector2d;

constexpr double kHair_m = 1e-3;     // walls that touch do so with rounding
constexpr double kJoint_m = 0.01;    // faces that go on in each other
constexpr double kOnFace_m = 0.1;
constexpr double kInwards_m = 0.25;  // there the wall's face is looked for, not at its very end
const double kSameDirection = std::cos(10 * kPi / 180);

double cross(const Vec& u, const Vec& v) { return u.x() * v.y() - u.y() * v.x(); }

struct Interval {
  double from, to;
};

/// Where along p -> q (0..1) a thick wall covers it; empty when from >= to.
Interval covered(const Vec& p, const Vec& q, const MapWall& wall) {
  const Vec u = (wall.b - wall.a).normalized(), n(-u.y(), u.x());
  const double length_m = (wall.b - wall.a).norm(), half_m = 0.5 * wall.thickness_m;
  Interval in{0, 1};
  const auto clip = [&](double at_p, double at_q, double low, double high) {
    const double step = at_q - at_p;
    if (std::abs(step) < 1e-12) {
      if (at_p < low || at_p > high) in = {1, 0};
      return;
    }
    const double s = (low - at_p) / step, t = (high - at_p) / step;
    in = {std::max(in.from, std::min(s, t)), std::min(in.to, std::max(s, t))};
  };
  clip(u.dot(p - wall.a), u.dot(q - wall.a), -kHair_m, length_m + kHair_m);
  clip(n.dot(p - wall.a), n.dot(q - wall.a), -half_m + kHair_m, half_m - kHair_m);
  return in;
}

/// What is left of p -> q when all intervals are taken away.
void add_rest(const Vec& p, const Vec& q, std::vector<Interval> gone, std::vector<WallFace>& faces) {
  std::sort(gone.begin(), gone.end(), [](const Interval& a, const Interval& b) { return a.from < b.from; });
  gone.push_back({1, 1});
  double at = 0;
  for (const Interval& one : gone) {
    if ((one.from - at) * (q - p).norm() > kJoint_m) faces.push_back({p + at * (q - p), p + one.from * (q - p)});
    at = std::max(at, one.to);
  }
}

/// Faces of two walls in line, end to end, are one.
void join(std::vector<WallFace>& faces) {
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (std::size_t j = 0; j < faces.size();) {
      const bool goes_on = i != j && (faces[i].b - faces[j].a).norm() < kJoint_m &&
                           (faces[i].b - faces[i].a).normalized().dot((faces[j].b - faces[j].a).normalized()) > 1 - 1e-4;
      if (!goes_on) {
        ++j;
        continue;
      }
      faces[i].b = faces[j].b;
      faces.erase(faces.begin() + static_cast<std::ptrdiff_t>(j));
      if (j < i) --i;
      j = 0;
    }
}

/// The face that a place of a wall with direction u lies on.
const WallFace* face_at(const std::vector<WallFace>& faces, const Vec& place, const Vec& u) {
  const WallFace* nearest = nullptr;
  double nearest_m = kOnFace_m;
  for (const WallFace& face : faces) {
    const Vec d = (face.b - face.a).normalized();
    const double along_m = d.dot(place - face.a), across_m = std::abs(cross(d, place - face.a));
    if (std::abs(d.dot(u)) < kSameDirection || along_m < -kOnFace_m || along_m > (face.b - face.a).norm() + kOnFace_m || across_m > nearest_m) continue;
    nearest = &face;
    nearest_m = across_m;
  }
  return nearest;
}

double share_within(const std::vector<double>& in_sigmas) {
  const auto within = std::count_if(in_sigmas.begin(), in_sigmas.end(), [](double x) { return x <= 2; });
  return in_sigmas.empty() ? 0 : static_cast<double>(within) / static_cast<double>(in_sigmas.size());
}

}  // namespace

std::vector<WallFace> true_faces(const std::vector<MapWall>& walls) {
  std::vector<WallFace> faces;
  for (const MapWall& wall : walls) {
    if ((wall.b - wall.a).norm() < kHair_m) continue;
    const Vec u = (wall.b - wall.a).normalized(), to_side = 0.5 * wall.thickness_m * Vec(-u.y(), u.x());
    for (const double side : {1.0, -1.0}) {
      const Vec p = (side > 0 ? wall.a : wall.b) + side * to_side, q = (side > 0 ? wall.b : wall.a) + side * to_side;
      std::vector<Interval> gone;
      for (const MapWall& other : walls)
        if (&other != &wall && other.thickness_m > 0)
          if (const Interval in = covered(p, q, other); in.from < in.to) gone.push_back(in);
      add_rest(p, q, gone, faces);
    }
  }
  join(faces);
  return faces;
}

WallEndScores score_wall_ends(const SemanticMap& found, const SemanticMap& truth) {
  const std::vector<WallFace> faces = true_faces(truth.walls);
  WallEndScores scores;
  std::vector<double> along_m, across_m, along_sigmas, across_sigmas;
  for (const MapWall& wall : found.walls) {
    const double length_m = (wall.b - wall.a).norm();
    for (std::size_t k = 0; k < wall.ends.size() && length_m > 0; ++k) {
      const MapWallEnd& end = wall.ends[k];
      if (!end.seen) continue;
      ++scores.told;
      const Vec p = k == 0 ? wall.a : wall.b, u = (k == 0 ? wall.a - wall.b : wall.b - wall.a) / length_m;
      const WallFace* face = face_at(faces, p - std::min(kInwards_m, 0.5 * length_m) * u, u);
      if (!face) continue;
      ++scores.on_face;
      const Vec d = (face->b - face->a).normalized(), true_end = d.dot(u) > 0 ? face->b : face->a;
      along_m.push_back(std::abs(u.dot(true_end - p)));
      across_m.push_back(std::abs(cross(d, p - face->a)));
      along_sigmas.push_back(along_m.back() / end.along_m);
      across_sigmas.push_back(across_m.back() / end.across_m);
    }
  }
  scores.along_m = statistics_of(along_m);
  scores.across_m = statistics_of(across_m);
  scores.along_within = share_within(along_sigmas);
  scores.across_within = share_within(across_sigmas);
  return scores;
}

}  // namespace modslam
