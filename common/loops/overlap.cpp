// SPDX-License-Identifier: BSD-3-Clause
#include "common/loops/overlap.hpp"

#include <algorithm>
#include <cmath>

#include "common/loops/quad_tree.hpp"
#include "common/matching/point_to_line.hpp"
#include "common/matching/verdict.hpp"

namespace modslam {
namespace {

constexpr double kNear_m = 3.0;            // only scans taken this near to each other are compared
constexpr int kPartners = 8;               // of a node: the nearest earlier ones
constexpr std::size_t kPoints = 90;        // of a scan that are compared
constexpr double kMinOverlap = 0.35;       // share of them that must find a partner
constexpr int kFewestPairs = 20;
constexpr double kMaxMove_m = 0.10;        // a polish moves nothing far
constexpr double kInformationScale = 0.1;  // neighbouring beams err alike
constexpr double kMaxSigma_m = 0.05, kMinShare = 0.01;  // of a direction that counts as observed

/// The surfaces of one scan in its robot frame, found by projection into its beams.
class ScanView : public SurfaceSource {
 public:
  explicit ScanView(Keyframe node) : eye_(node.eye_base), points_(std::move(node.points_base)) {
    points_.erase(std::remove_if(points_.begin(), points_.end(), [](const OrientedPoint& point) { return !point.has_normal(); }),
                  points_.end());
    std::sort(points_.begin(), points_.end(),
              [this](const OrientedPoint& a, const OrientedPoint& b) { return bearing_of(a.p) < bearing_of(b.p); });
    for (const OrientedPoint& point : points_) bearings_.push_back(static_cast<float>(bearing_of(point.p)));
  }

  bool nearest_surface(const Eigen::Vector2d& p, const Eigen::Vector2d& n, double gate_m, double min_cosine, Surface& out) const override {
    const double bearing = bearing_of(p), half = std::min(1.0, gate_m / std::max((p - eye_).norm(), gate_m));
    const OrientedPoint* nearest = nullptr;
    double best_d2 = gate_m * gate_m;
    const auto first = std::lower_bound(bearings_.begin(), bearings_.end(), bearing - half);
    for (auto k = static_cast<std::size_t>(first - bearings_.begin()); k < points_.size() && bearings_[k] < bearing + half; ++k) {
      const double d2 = (points_[k].p - p).squaredNorm();
      if (d2 >= best_d2 || points_[k].n.dot(n) < min_cosine) continue;
      best_d2 = d2;
      nearest = &points_[k];
    }
    if (nearest) out = {nearest->p, nearest->n, nearest->var_m2, nearest->var_normal_rad2, 1};
    return nearest != nullptr;
  }

  /// Evenly spread over the scan.
  std::vector<OrientedPoint> some_points() const {
    std::vector<OrientedPoint> some;
    const std::size_t step = std::max<std::size_t>(1, points_.size() / kPoints);
    for (std::size_t k = 0; k < points_.size(); k += step) some.push_back(points_[k]);
    return some;
  }

 private:
  /// -2..2, grows with the bearing like an angle, by half to one a radian; cheaper than one.
  double bearing_of(const Eigen::Vector2d& p) const {
    const Eigen::Vector2d d = p - eye_;
    const double share = d.y() / std::max(std::abs(d.x()) + std::abs(d.y()), 1e-9);
    return d.x() >= 0 ? share : d.y() >= 0 ? 2 - share : -2 - share;
  }

  Eigen::Vector2d eye_;
  std::vector<OrientedPoint> points_;  ///< by bearing as the laser sees them
  std::vector<float> bearings_;
};

/// The pose of the later node as the earlier one sees it. @return whether their scans overlap enough to say.
bool measure(const ScanView& earlier, const std::vector<OrientedPoint>& later, const Pose2& T_from_to, GraphEdge& edge) {
  RefineOptions options;
  options.gate_start_m = options.gate_end_m = 0.15;
  options.robust_m = 0.03;
  options.max_iterations = 4;
  const RefineResult fit = refine(later, earlier, T_from_to, options);
  if (fit.pairs < kFewestPairs || fit.pairs < kMinOverlap * static_cast<double>(later.size())) return false;
  if (distance(fit.T_map_base, T_from_to) > kMaxMove_m) return false;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.topLeftCorner<2, 2>() = rotation(fit.T_map_base.heading);
  edge.T_from_to = fit.T_map_base;
  edge.information = kInformationScale * R.transpose() * observed_information(fit, kMaxSigma_m, kMinShare).information * R;
  return true;
}

/// Nodes of the tree around a place, nearest first.
std::vector<QuadTree::Entry> nearest_nodes(const QuadTree& tree, const Eigen::Vector2d& p) {
  std::vector<QuadTree::Entry> near = tree.near(p, kNear_m);
  std::sort(near.begin(), near.end(), [&](const QuadTree::Entry& a, const QuadTree::Entry& b) {
    const double da = (a.p - p).squaredNorm(), db = (b.p - p).squaredNorm();
    return da != db ? da < db : a.id < b.id;
  });
  return near;
}

}  // namespace

std::vector<GraphEdge> measure_overlaps(std::vector<Keyframe> nodes) {
  QuadTree earlier;
  std::vector<ScanView> views;
  views.reserve(nodes.size());
  std::vector<GraphEdge> edges;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const Pose2 T_map_to = nodes[k].T_map_base;
    views.emplace_back(std::move(nodes[k]));
    const std::vector<OrientedPoint> points = views.back().some_points();
    int found = 0;
    for (const QuadTree::Entry& entry : nearest_nodes(earlier, T_map_to.translation())) {
      const auto from = static_cast<std::size_t>(entry.id);
      if (found == kPartners) break;
      if (k - from < 2) continue;  // the sequence says it already
      GraphEdge edge;
      edge.id = static_cast<EdgeId>(edges.size());
      edge.from = entry.id;
      edge.to = static_cast<NodeId>(k);
      edge.kind = EdgeKind::kLoop;
      if (!measure(views[from], points, between(nodes[from].T_map_base, T_map_to), edge)) continue;
      edges.push_back(edge);
      ++found;
    }
    earlier.insert(T_map_to.translation(), static_cast<NodeId>(k));
  }
  return edges;
}

}  // namespace modslam
