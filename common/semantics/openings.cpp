// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/openings.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "common/geometry/pose2.hpp"

namespace modslam {
namespace {

using Vec = Eigen::Vector2d;

constexpr double kOutline_m = 0.12;      // detail of the outline that makes no corner
constexpr double kReflex_rad = 0.5;      // least turn of a corner
constexpr int kPerCorner = 6;            // shortest cuts kept from each corner
constexpr double kBeyond_m = 1.0, kHitBeyond_m = 0.6, kWay_m = 4.0, kBeside_m = 0.35, kMostFlare = 4;
constexpr double kAtWall_m = 0.25, kLongWall_m = 3.0;

double cross(const Vec& a, const Vec& b) { return a.x() * b.y() - a.y() * b.x(); }

/// A corner that the floor goes round, and the outline's directions away from it. Cells.
struct Corner {
  Vec p, before, after;
  double turn_rad;
};

struct Edge {
  Vec a, b;
};

struct Outline {
  std::vector<Corner> corners;
  std::vector<Edge> edges;
};

Outline trace(const Floor& floor) {
  Outline out;
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(floor.open, contours, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
  for (const auto& contour : contours) {
    std::vector<cv::Point> ring;
    cv::approxPolyDP(contour, ring, kOutline_m / floor.resolution_m, true);
    const std::size_t n = ring.size();
    if (n < 2) continue;
    const auto at = [&](std::size_t k) { return Vec(ring[k % n].x, ring[k % n].y); };
    for (std::size_t k = 0; k < n; ++k) {
      const Vec p = at(k), before = (at(k + n - 1) - p).normalized(), after = (at(k + 1) - p).normalized();
      out.edges.push_back({p, at(k + 1)});
      // OpenCV keeps the floor on one side of all contours, outer ones and holes alike: there a corner turns the other way.
      const double turn = std::atan2(cross(-before, after), -before.dot(after));
      if (turn > kReflex_rad || n == 2) out.corners.push_back({p, before, after, n == 2 ? kPi : turn});
    }
  }
  return out;
}

class OpeningFinder {
 public:
  OpeningFinder(const Floor& floor, const KnownSpace& space, const std::vector<Wall>& walls, double max_width_m)
      : floor_(floor), space_(space), walls_(walls), outline_(trace(floor)), cell_m_(floor.resolution_m), reach_(max_width_m / cell_m_) {}

  std::vector<Opening> run() {
    collect();
    std::vector<Opening> out;
    for (std::size_t k = 0; k < cuts_.size(); ++k) out.push_back(measured(k));
    return out;
  }

 private:
  struct Cut {
    Vec a, b;
    int first = -1, second = -1;  ///< corners; second -1: b lies on an edge
    Vec edge{0, 0};               ///< direction of that edge
    double length() const { return (b - a).norm(); }
    Vec centre() const { return 0.5 * (a + b); }
  };

  bool inside(const Vec& p) const { return p.x() >= 0 && p.y() >= 0 && p.x() < floor_.open.cols && p.y() < floor_.open.rows; }
  static cv::Point cell(const Vec& p) { return {static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y()))}; }
  bool is_open(const Vec& p) const {
    const cv::Point c = cell(p);
    return c.x >= 0 && c.y >= 0 && c.x < floor_.open.cols && c.y < floor_.open.rows && floor_.open(c);
  }
  bool is_clear(const Vec& a, const Vec& b) const {
    const double length = (b - a).norm();
    const int steps = std::max(2, static_cast<int>(2 * length));
    for (int k = 0; k <= steps; ++k) {
      const double s = length * k / steps;
      if (s < 1.5 || length - s < 1.5) continue;
      if (!is_open(a + (b - a) * k / steps)) return false;
    }
    return true;
  }

  void collect() {
    const double shortest = 0.3 / cell_m_;
    for (std::size_t i = 0; i < outline_.corners.size(); ++i) {
      const Corner& corner = outline_.corners[i];
      std::vector<Cut> to_corners, to_edges;
      for (std::size_t j = 0; j < outline_.corners.size(); ++j) {
        if (std::abs(outline_.corners[j].p.x() - corner.p.x()) > reach_ || std::abs(outline_.corners[j].p.y() - corner.p.y()) > reach_) continue;
        const Cut cut{corner.p, outline_.corners[j].p, static_cast<int>(i), static_cast<int>(j)};
        if (j != i && cut.length() >= shortest && cut.length() <= reach_) to_corners.push_back(cut);
      }
      for (const Edge& edge : outline_.edges) {
        const Vec d = edge.b - edge.a;
        const Vec from = corner.p - edge.a;
        if (std::min(from.x(), from.x() - d.x()) > reach_ || std::max(from.x(), from.x() - d.x()) < -reach_) continue;
        if (std::min(from.y(), from.y() - d.y()) > reach_ || std::max(from.y(), from.y() - d.y()) < -reach_) continue;
        const double share = d.dot(corner.p - edge.a) / d.squaredNorm();
        if (share <= 0.02 || share >= 0.98) continue;
        const Cut cut{corner.p, edge.a + share * d, static_cast<int>(i), -1, d.normalized()};
        if (cut.length() >= shortest && cut.length() <= reach_) to_edges.push_back(cut);
      }
      keep_shortest(to_corners, true);
      keep_shortest(to_edges, false);
    }
    drop_twins();
  }

  /// @param mutual  the cut is met again from its other corner.
  void keep_shortest(std::vector<Cut>& cuts, bool mutual) {
    std::stable_sort(cuts.begin(), cuts.end(), [](const Cut& p, const Cut& q) { return p.length() < q.length(); });
    int kept = 0;
    for (const Cut& cut : cuts) {
      if (!is_clear(cut.a, cut.b)) continue;
      if (++kept > kPerCorner) break;
      if (!mutual || cut.first < cut.second) cuts_.push_back(cut);
    }
  }

  void drop_twins() {
    std::stable_sort(cuts_.begin(), cuts_.end(), [](const Cut& p, const Cut& q) { return p.length() < q.length(); });
    const double near = 0.12 / cell_m_;
    std::vector<Cut> kept;
    for (const Cut& cut : cuts_) {
      const bool twin = std::any_of(kept.rbegin(), kept.rend(), [&](const Cut& other) {
        if (std::abs(cut.a.x() + cut.b.x() - other.a.x() - other.b.x()) > 2 * near || std::abs(cut.a.y() + cut.b.y() - other.a.y() - other.b.y()) > 2 * near)
          return false;
        return ((cut.a - other.a).norm() < near && (cut.b - other.b).norm() < near) || ((cut.a - other.b).norm() < near && (cut.b - other.a).norm() < near);
      });
      if (!twin) kept.push_back(cut);
    }
    cuts_ = std::move(kept);
  }

  /// Metres of not-floor in line beyond p, a cell to either side allowed.
  double solid_beyond_m(const Vec& p, const Vec& out) const {
    const Vec side(-out.y(), out.x());
    double last = 0;
    for (double s = 1; s * cell_m_ <= kBeyond_m; s += 0.5) {
      const Vec q = p + s * out;
      const bool solid = !is_open(q) || !is_open(q + side) || !is_open(q - side);
      if (solid) last = s;
      else if (s - last > 2) break;
    }
    return last * cell_m_;
  }

  double hit_share(const Vec& p, const Vec& out) const {
    int hit = 0, asked = 0;
    for (double s = 0.5; s * cell_m_ <= kHitBeyond_m; s += 1, ++asked) {
      const cv::Point c = cell(p + s * out);
      const cv::Rect around = cv::Rect(c.x - 2, c.y - 2, 5, 5) & cv::Rect(0, 0, floor_.solid.cols, floor_.solid.rows);
      hit += !around.empty() && cv::countNonZero(floor_.solid(around)) > 0;
    }
    return asked ? static_cast<double>(hit) / asked : 0;
  }

  struct Side {
    double depth_m = 0, clearance = 0, flare = 0;
  };
  Side look(const Cut& cut, const Vec& n) const {
    Side side;
    const Vec u = (cut.b - cut.a).normalized();
    for (const double t : {0.3, 0.5, 0.7}) {
      const Vec from = cut.a + t * (cut.b - cut.a);
      double s = 1;
      double clearance = 0;
      for (; s * cell_m_ <= kWay_m && is_open(from + s * n); s += 1)
        if (s * cell_m_ <= 2.5) clearance = std::max<double>(clearance, floor_.clearance(cell(from + s * n)));
      side.depth_m = std::max(side.depth_m, (s - 1) * cell_m_);
      side.clearance = std::max(side.clearance, clearance);
    }
    const Vec beside = cut.centre() + kBeside_m / cell_m_ * n;
    if (is_open(beside)) {
      const double most = kMostFlare * cut.length();
      double width = 0;
      for (const Vec& way : {u, Vec(-u)})
        for (double s = 1; width < most && is_open(beside + s * way); s += 1) width += 1;
      side.flare = std::min(kMostFlare, width / cut.length());
    }
    return side;
  }

  double align(const Cut& cut, bool at_a) const {
    const Vec u = (cut.b - cut.a).normalized();
    const int corner = at_a ? cut.first : cut.second;
    if (corner < 0) return std::abs(u.dot(cut.edge));
    const Corner& c = outline_.corners[static_cast<std::size_t>(corner)];
    const Vec out = at_a ? Vec(-u) : u;  // a wall in line runs away from the cut
    return std::max(out.dot(c.before), out.dot(c.after));
  }

  double wall_at_m(const Vec& p) const {
    double longest = 0;
    for (const Wall& wall : walls_) {
      if ((p.array() < wall.a.cwiseMin(wall.b).array() - kAtWall_m).any() || (p.array() > wall.a.cwiseMax(wall.b).array() + kAtWall_m).any()) continue;
      const Vec u = wall.direction();
      const double along = u.dot(p - wall.a), across = u.x() * (p - wall.a).y() - u.y() * (p - wall.a).x();
      if (std::abs(across) < kAtWall_m && along > -kAtWall_m && along < wall.length_m() + kAtWall_m) longest = std::max(longest, wall.length_m());
    }
    return std::min(longest, kLongWall_m);
  }

  double narrowest_near(std::size_t k) const {
    const Cut& cut = cuts_[k];
    double least = cut.length();
    for (const Cut& other : cuts_) {  // shortest first
      if (other.length() >= least) break;
      if ((other.centre() - cut.centre()).norm() < 0.5 * cut.length() + 0.2 / cell_m_) return other.length();
    }
    return least;
  }

  Opening measured(std::size_t k) const {
    const Cut& cut = cuts_[k];
    const Vec u = (cut.b - cut.a).normalized(), n(-u.y(), u.x());
    Opening out;
    const auto place = [&](const Vec& p) -> Vec { return space_.origin_m + cell_m_ * (p + Vec(0.5, 0.5)); };
    out.a = place(cut.a);
    out.b = place(cut.b);
    auto& f = out.features;
    const auto pair = [&](OpeningFeature less, double p, double q) {
      f[less] = static_cast<float>(std::min(p, q));
      f[less + 1] = static_cast<float>(std::max(p, q));
    };
    const double half = 0.5 * cut.length();
    const Side left = look(cut, n), right = look(cut, -n);
    f[kWidth] = static_cast<float>(cut.length() * cell_m_);
    pair(kSolidLess, solid_beyond_m(cut.a, -u), solid_beyond_m(cut.b, u));
    pair(kHitLess, hit_share(cut.a, -u), hit_share(cut.b, u));
    pair(kDepthLess, left.depth_m, right.depth_m);
    pair(kRoomyLess, left.clearance / half, right.clearance / half);
    pair(kClearLess, left.clearance * cell_m_, right.clearance * cell_m_);
    pair(kTurnLess, outline_.corners[static_cast<std::size_t>(cut.first)].turn_rad,
         cut.second < 0 ? 0.0 : outline_.corners[static_cast<std::size_t>(cut.second)].turn_rad);
    pair(kAlignLess, align(cut, true), align(cut, false));
    pair(kFlareLess, left.flare, right.flare);
    f[kMidClear] = static_cast<float>(floor_.clearance(cell(cut.centre())) / half);
    f[kLocal] = static_cast<float>(cut.length() / narrowest_near(k));
    pair(kWallLess, wall_at_m(out.a), wall_at_m(out.b));
    return out;
  }

  const Floor& floor_;
  const KnownSpace& space_;
  const std::vector<Wall>& walls_;
  Outline outline_;
  double cell_m_, reach_;
  std::vector<Cut> cuts_;
};

}  // namespace

std::vector<Opening> find_openings(const Floor& floor, const KnownSpace& space, const std::vector<Wall>& walls, double max_width_m,
                                   const OpeningModel& model) {
  if (floor.open.empty()) return {};
  std::vector<Opening> openings = OpeningFinder(floor, space, walls, max_width_m).run();
  for (Opening& opening : openings) opening.probability = model.probability(opening.features.data());
  return openings;
}

}  // namespace modslam
