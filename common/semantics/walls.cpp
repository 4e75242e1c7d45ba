// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/walls.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace modslam {
namespace {

constexpr double kWeightCap = 20;       // beams of one cell are not independent
constexpr double kLogOddsOfBeam = 0.4;  // of one classified beam end
constexpr double kLogOddsCap = 6;
constexpr int kReach = 2;                // [cells] pieces grow over gaps of one cell
constexpr double kLikeAngle_rad = 0.38;  // of cells in one region
constexpr double kAcross_m = 0.06;       // farther cells are not on the line
constexpr double kSmallGap_m = 0.35;     // joined whatever was seen in between
constexpr double kJoinSine = 0.10;       // of the angle between pieces that join

double angle_between(double a, double b) { return std::abs(std::remainder(a - b, kPi)); }

Eigen::Vector2d left_normal(const Eigen::Vector2d& d) { return {-d.y(), d.x()}; }

/// Line and extent of the face from its cells. @return false when they are no line.
bool fit(WallFace& face, const std::vector<OrientedCell>& cells) {
  std::vector<Eigen::Vector2d> points;
  std::vector<double> weights;
  double evidence = 0;
  for (const int c : face.cells) {
    const OrientedCell& cell = cells[static_cast<std::size_t>(c)];
    points.push_back(cell.p);
    weights.push_back(cell.weight);
    evidence += cell.log_odds;
  }
  const FittedLine line = fit_line(points, weights);
  double low = 1e9, high = -1e9;
  for (const Eigen::Vector2d& p : points) {
    const double along = line.direction.dot(p - line.centre);
    low = std::min(low, along);
    high = std::max(high, along);
  }
  face.segment = {line.centre + low * line.direction, line.centre + high * line.direction};
  face.sigma_m = line.sigma_m;
  face.evidence = evidence / static_cast<double>(points.size());
  return high > low;
}

void longest_first(std::vector<WallFace>& faces) {
  std::stable_sort(faces.begin(), faces.end(), [](const WallFace& a, const WallFace& b) {
    return a.segment.length_m() > b.segment.length_m();
  });
}

/// Thesis: joinable(Set, Seg).
bool joinable(const WallFace& longer, const WallFace& shorter, const Evidence& evidence,
              double hidden_gap_m) {
  const Segment &l = longer.segment, &s = shorter.segment;
  const Eigen::Vector2d d = l.direction(), n = left_normal(d);
  if (std::abs(n.dot(s.a - l.a)) > kAcross_m + 0.02 * hidden_gap_m) return false;
  const double sine = std::abs(n.dot(s.direction()));
  if (sine > std::max(kJoinSine, std::min(0.35, kAcross_m / s.length_m()))) return false;
  double low = d.dot(s.a - l.a), high = d.dot(s.b - l.a);
  const bool flipped = low > high;
  if (flipped) std::swap(low, high);
  const double length = l.length_m();
  const double gap = std::max(low - length, -high);
  // A line continues straight: what may be off grows with the gap as the slopes are uncertain.
  const double across = kAcross_m + 0.02 * std::clamp(gap, 0.0, hidden_gap_m);
  if (std::abs(n.dot(s.a - l.a)) > across || std::abs(n.dot(s.b - l.a)) > across) return false;
  if (gap <= kSmallGap_m) return true;
  if (gap > hidden_gap_m) return false;
  const bool after = low > length;
  const Eigen::Vector2d& near_end = after == flipped ? s.b : s.a;
  return seen_free(after ? l.b : l.a, near_end, evidence) < 0.2;
}

/// Share of the face's length that its cells cover.
double coverage(const WallFace& face, const std::vector<OrientedCell>& cells, double resolution_m) {
  const Eigen::Vector2d d = face.segment.direction();
  const int n = std::max(1, static_cast<int>(face.segment.length_m() / (2 * resolution_m)));
  std::vector<bool> covered(static_cast<std::size_t>(n));
  for (const int c : face.cells) {
    const double t =
        d.dot(cells[static_cast<std::size_t>(c)].p - face.segment.a) / (2 * resolution_m);
    covered[static_cast<std::size_t>(std::clamp(static_cast<int>(t), 0, n - 1))] = true;
  }
  return static_cast<double>(std::count(covered.begin(), covered.end(), true)) / n;
}

/// Turns the face so that its viewers stand to its left.
void turn_to_viewers(WallFace& face, const std::vector<OrientedCell>& cells) {
  Eigen::Vector2d view(0, 0);
  for (const int c : face.cells) view += cells[static_cast<std::size_t>(c)].view;
  if (view.dot(left_normal(face.segment.direction())) < 0)
    std::swap(face.segment.a, face.segment.b);
}

}  // namespace

double seen_free(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Evidence& evidence) {
  const int n = std::max(1, static_cast<int>((b - a).norm() / 0.1));
  int crossed = 0;
  for (int i = 0; i < n; ++i) crossed += evidence.crossings(a + (i + 0.5) / n * (b - a)) > 1;
  return static_cast<double>(crossed) / n;
}

std::vector<OrientedCell> oriented_cells(const Evidence& evidence) {
  std::vector<OrientedCell> cells;
  evidence.hits().each([&](int ix, int iy, const HitCell& cell) {
    if (cell.wall < 1 || 2 * cell.wall < cell.hits()) return;
    const Eigen::Vector2d centre(evidence.hits().centre_m(ix), evidence.hits().centre_m(iy));
    if (evidence.crossings(centre) > 15 * cell.hits()) return;
    double angle = 0.5 * std::atan2(cell.sin2, cell.cos2);
    if (angle < 0) angle += kPi;
    const Eigen::Vector2d offset(cell.dx_mm, cell.dy_mm);
    cells.push_back(
        {ix, iy, centre + offset / (1000.0 * cell.hits()), angle,
         Eigen::Vector2d(cell.view_x, cell.view_y) / (100.0 * cell.hits()),
         std::min<double>(cell.hits(), kWeightCap),
         std::clamp(kLogOddsOfBeam * (cell.wall - cell.object), -kLogOddsCap, kLogOddsCap)});
  });
  return cells;
}

std::vector<WallFace> grow_faces(const std::vector<OrientedCell>& cells, double resolution_m) {
  TileGrid<std::int32_t> index(resolution_m);
  for (std::size_t i = 0; i < cells.size(); ++i)
    index.at(cells[i].ix, cells[i].iy) = static_cast<std::int32_t>(i + 1);
  std::vector<int> seeds(cells.size());
  std::iota(seeds.begin(), seeds.end(), 0);
  std::stable_sort(seeds.begin(), seeds.end(), [&](int a, int b) {
    return cells[static_cast<std::size_t>(a)].weight > cells[static_cast<std::size_t>(b)].weight;
  });
  std::vector<bool> taken(cells.size());
  std::vector<WallFace> faces;
  for (const int seed : seeds) {
    if (taken[static_cast<std::size_t>(seed)]) continue;
    WallFace face;
    face.cells.push_back(seed);
    taken[static_cast<std::size_t>(seed)] = true;
    const OrientedCell& first = cells[static_cast<std::size_t>(seed)];
    FittedLine line{first.p, {std::cos(first.angle_rad), std::sin(first.angle_rad)}, 0};
    const double facing = left_normal(line.direction).dot(first.view);
    std::size_t refit_at = 6;
    for (std::size_t k = 0; k < face.cells.size(); ++k) {
      const OrientedCell& from = cells[static_cast<std::size_t>(face.cells[k])];
      for (int dy = -kReach; dy <= kReach; ++dy) {
        for (int dx = -kReach; dx <= kReach; ++dx) {
          const std::int32_t* slot = index.find(from.ix + dx, from.iy + dy);
          if (!slot || *slot == 0 || taken[static_cast<std::size_t>(*slot - 1)]) continue;
          const OrientedCell& cell = cells[static_cast<std::size_t>(*slot - 1)];
          if (angle_between(cell.angle_rad, std::atan2(line.direction.y(), line.direction.x())) >
              kLikeAngle_rad)
            continue;
          if (std::abs(left_normal(line.direction).dot(cell.p - line.centre)) > kAcross_m) continue;
          if (left_normal(line.direction).dot(cell.view) * facing < 0)
            continue;  // the other face of a thin wall
          taken[static_cast<std::size_t>(*slot - 1)] = true;
          face.cells.push_back(*slot - 1);
        }
      }
      if (face.cells.size() >= refit_at) {
        refit_at = face.cells.size() * 3 / 2;
        fit(face, cells);
        if (face.segment.length_m() > 0.3) {
          const Eigen::Vector2d d = face.segment.direction();
          line = {face.segment.centre(), d.dot(line.direction) < 0 ? Eigen::Vector2d(-d) : d, 0};
        }
      }
    }
    if (face.cells.size() >= 3 && fit(face, cells)) faces.push_back(std::move(face));
  }
  longest_first(faces);
  return faces;
}

std::vector<WallFace> merge_faces(std::vector<WallFace> faces,
                                  const std::vector<OrientedCell>& cells, const Evidence& evidence,
                                  double hidden_gap_m) {
  for (bool joined = true; joined;) {
    joined = false;
    std::vector<WallFace> merged;
    std::vector<bool> taken(faces.size());
    for (std::size_t i = 0; i < faces.size(); ++i) {
      if (taken[i]) continue;
      WallFace face = std::move(faces[i]);
      for (std::size_t j = i + 1; j < faces.size(); ++j) {
        if (taken[j] || !joinable(face, faces[j], evidence, hidden_gap_m)) continue;
        face.cells.insert(face.cells.end(), faces[j].cells.begin(), faces[j].cells.end());
        fit(face, cells);
        taken[j] = joined = true;
      }
      merged.push_back(std::move(face));
    }
    longest_first(merged);
    faces = std::move(merged);
  }
  for (WallFace& face : faces) turn_to_viewers(face, cells);
  return faces;
}

std::vector<WallFace> find_faces(const std::vector<OrientedCell>& cells, const Evidence& evidence,
                                 double min_length_m) {
  const double resolution_m = evidence.hits().resolution_m();
  std::vector<WallFace> faces = merge_faces(grow_faces(cells, resolution_m), cells, evidence, 0);
  const auto useless = [&](const WallFace& face) {
    return face.segment.length_m() < min_length_m || coverage(face, cells, resolution_m) < 0.5;
  };
  faces.erase(std::remove_if(faces.begin(), faces.end(), useless), faces.end());
  return faces;
}

}  // namespace modslam
