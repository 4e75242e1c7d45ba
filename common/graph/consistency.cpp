// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/consistency.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <numeric>

namespace modslam {
namespace {

constexpr double kMargin = 4;

/// Takes small motions (x y heading) at the far end of T to those at its near end: T exp(v) = exp(adjoint(T) v) T.
Eigen::Matrix3d adjoint(const Pose2& T) {
  Eigen::Matrix3d A = Eigen::Matrix3d::Identity();
  A.topLeftCorner<2, 2>() = rotation(T.heading);
  A(0, 2) = T.y;
  A(1, 2) = -T.x;
  return A;
}

Eigen::Matrix3d carried(const Pose2& T, const Eigen::Matrix3d& covariance) {
  const Eigen::Matrix3d A = adjoint(T);
  return A * covariance * A.transpose();
}

/// Of an edge's error, at its far end. A direction that the edge says nothing of is unsure by 10 m or 3 rad.
Eigen::Matrix3d edge_covariance(const GraphEdge& edge) {
  const Eigen::Matrix3d floor = Eigen::Vector3d(1e-2, 1e-2, 1e-1).asDiagonal();
  return (edge.information + floor).inverse();
}

/// An edge seen from its node with the lower id.
struct Loop {
  NodeId low, high;
  Pose2 T_low_high;
  Eigen::Matrix3d covariance;  // at low

  explicit Loop(const GraphEdge& edge) {
    const bool forward = edge.from < edge.to;
    low = forward ? edge.from : edge.to;
    high = forward ? edge.to : edge.from;
    T_low_high = forward ? edge.T_from_to : edge.T_from_to.inverse();
    covariance = forward ? carried(edge.T_from_to, edge_covariance(edge)) : edge_covariance(edge);
  }
};

double ring_chi2(const DrivenWay& way, const Loop& a, const Loop& b) {
  const Pose2 T_a_high_b = a.T_low_high * way.motion(a.high, b.high), T_ab = way.motion(a.low, b.low);
  const Pose2 closure = T_a_high_b * (T_ab * b.T_low_high).inverse();
  const Eigen::Matrix3d covariance = a.covariance + carried(a.T_low_high, way.covariance(a.high, b.high)) +
                                     carried(T_ab, b.covariance) + way.covariance(a.low, b.low);
  const Eigen::Vector3d e = closure.vector();
  return e.dot(covariance.ldlt().solve(e));
}

}  // namespace

DrivenWay::DrivenWay(const PoseGraph& graph)
    : T_start_(graph.poses.size()), sum_(graph.poses.size(), Eigen::Matrix3d::Zero()), gaps_(graph.poses.size(), 0) {
  std::vector<const GraphEdge*> step_to(graph.poses.size(), nullptr);
  for (const GraphEdge& edge : graph.edges)
    if (edge.kind == EdgeKind::kSequence && std::abs(edge.from - edge.to) == 1) step_to[at(std::max(edge.from, edge.to))] = &edge;
  for (std::size_t k = 1; k < T_start_.size(); ++k) {
    gaps_[k] = gaps_[k - 1] + !step_to[k];
    T_start_[k] = T_start_[k - 1];
    sum_[k] = sum_[k - 1];
    if (!step_to[k]) continue;
    const Loop step(*step_to[k]);
    T_start_[k] = T_start_[k - 1] * step.T_low_high;
    sum_[k] += carried(T_start_[k - 1], step.covariance);
  }
}

Eigen::Matrix3d DrivenWay::covariance(NodeId a, NodeId b) const {
  if (gaps_[at(a)] != gaps_[at(b)]) return 1e6 * Eigen::Matrix3d::Identity();
  return carried(T_start_[at(a)].inverse(), sum_[at(std::max(a, b))] - sum_[at(std::min(a, b))]);
}

double ring_chi2(const DrivenWay& way, const GraphEdge& a, const GraphEdge& b) { return ring_chi2(way, Loop(a), Loop(b)); }

double fitted_limit(double limit, std::vector<double> chi2, double margin) {
  constexpr double kMedian = 2.366, kLowest = 1e-4;  // median of 3 degrees of freedom
  chi2.erase(std::remove_if(chi2.begin(), chi2.end(), [&](double value) { return !(value < limit); }), chi2.end());
  if (chi2.size() < 10) return limit;
  const auto middle = chi2.begin() + static_cast<std::ptrdiff_t>(chi2.size() / 2);
  std::nth_element(chi2.begin(), middle, chi2.end());
  return limit * std::min(1.0, margin * std::max(*middle / kMedian, kLowest));
}

std::vector<std::vector<std::size_t>> consistent_loops(const PoseGraph& graph, NodeId reach, double chi2_limit) {
  const DrivenWay way(graph);
  std::vector<std::size_t> edge_of;
  std::vector<Loop> loops;
  for (std::size_t k = 0; k < graph.edges.size(); ++k)
    if (graph.edges[k].kind == EdgeKind::kLoop) edge_of.push_back(k);
  std::stable_sort(edge_of.begin(), edge_of.end(), [&](std::size_t a, std::size_t b) {
    const GraphEdge &p = graph.edges[a], &q = graph.edges[b];
    return std::min(p.from, p.to) < std::min(q.from, q.to);
  });
  for (const std::size_t k : edge_of) loops.emplace_back(graph.edges[k]);
  struct Ring {
    std::size_t a, b;
    double chi2;
  };
  std::vector<Ring> rings;
  std::vector<double> closed;
  for (std::size_t a = 0; a < loops.size(); ++a)
    for (std::size_t b = a + 1; b < loops.size() && loops[b].low - loops[a].low <= reach; ++b) {
      if (std::abs(loops[b].high - loops[a].high) > reach) continue;
      rings.push_back({edge_of[a], edge_of[b], ring_chi2(way, loops[a], loops[b])});
      closed.push_back(rings.back().chi2);
    }
  const double limit = fitted_limit(chi2_limit, std::move(closed), kMargin);
  std::vector<std::vector<std::size_t>> friends(graph.edges.size());
  for (const Ring& ring : rings) {
    if (!(ring.chi2 < limit)) continue;
    friends[ring.a].push_back(ring.b);
    friends[ring.b].push_back(ring.a);
  }
  for (std::vector<std::size_t>& list : friends) std::sort(list.begin(), list.end());
  return friends;
}

std::vector<std::size_t> large_clique(const std::vector<std::vector<std::size_t>>& friends) {
  const auto many_first = [&](std::size_t a, std::size_t b) { return friends[a].size() > friends[b].size(); };
  std::vector<std::size_t> order(friends.size()), best;
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), many_first);
  for (const std::size_t seed : order) {
    if (friends[seed].size() < best.size()) break;  // no larger one can grow from here on
    std::vector<std::size_t> open = friends[seed], clique{seed};
    std::stable_sort(open.begin(), open.end(), many_first);
    for (const std::size_t next : open)
      if (std::all_of(clique.begin(), clique.end(),
                      [&](std::size_t in) { return std::binary_search(friends[in].begin(), friends[in].end(), next); }))
        clique.push_back(next);
    if (clique.size() > best.size()) best = std::move(clique);
  }
  std::sort(best.begin(), best.end());
  return best;
}

}  // namespace modslam
