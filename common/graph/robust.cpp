// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/robust.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>

#include "common/graph/consistency.hpp"

namespace modslam {
namespace {

constexpr NodeId kReach = 20;                // nodes; farther apart odometry says little in most graphs
constexpr double kRingChi2 = 11.34;          // 99 %
// See fitted_limit(). A loop that agrees with the graph as it is can hardly be wrong; one that could agree and has no friend may be.
constexpr double kAgreeMargin = 16, kAloneMargin = 2;
constexpr double kGate_m = 3.0, kGate_rad = 1.0;
constexpr int kMaxRounds = 30, kMaxGraduations = 120, kMaxAdmissions = 5;

bool is_loop(const GraphEdge& edge) { return edge.kind == EdgeKind::kLoop; }

PoseGraph part_of(const PoseGraph& graph, const std::vector<bool>& believed) {
  PoseGraph part;
  part.poses = graph.poses;
  for (std::size_t k = 0; k < graph.edges.size(); ++k)
    if (believed[k]) part.edges.push_back(graph.edges[k]);
  return part;
}

using Friends = std::vector<std::vector<std::size_t>>;  // consistent_loops()

/// Loops with two consistent neighbours that are consistent with each other.
std::vector<bool> supported_loops(const Friends& friends) {
  std::vector<bool> supported(friends.size(), false);
  for (std::size_t k = 0; k < friends.size(); ++k)
    for (std::size_t a = 0; a < friends[k].size() && !supported[k]; ++a) {
      const std::size_t one = friends[k][a];
      for (std::size_t b = a + 1; b < friends[k].size() && !supported[k]; ++b) {
        const std::size_t other = friends[k][b];
        if (!std::binary_search(friends[one].begin(), friends[one].end(), other)) continue;
        supported[k] = supported[one] = supported[other] = true;
      }
    }
  return supported;
}

/// Squared errors of the loops that are believed.
std::vector<double> loop_chi2(const PoseGraph& graph, const std::vector<bool>& believed) {
  std::vector<double> chi2;
  for (std::size_t k = 0; k < graph.edges.size(); ++k)
    if (believed[k] && is_loop(graph.edges[k])) chi2.push_back(edge_chi2(graph.edges[k], graph.poses));
  return chi2;
}

/// Loops that are refused though the graph, unsure as it is between their nodes, allows them.
std::vector<std::size_t> allowed_loops(const PoseGraph& graph, const std::vector<bool>& believed, const Friends& friends, double chi2_limit) {
  const PoseGraph part = part_of(graph, believed);
  SparseOptimizer optimizer(part);
  optimizer.prepare_marginals(part);
  const std::vector<double> chi2 = loop_chi2(graph, believed);
  const double limit_alone = fitted_limit(chi2_limit, chi2, kAloneMargin), limit_in_pairs = fitted_limit(chi2_limit, chi2, kAgreeMargin);
  std::vector<std::size_t> allowed;
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    const GraphEdge& edge = graph.edges[k];
    if (believed[k] || !is_loop(edge)) continue;
    const Eigen::Vector3d e = edge_error(edge, graph.poses[static_cast<std::size_t>(edge.from)], graph.poses[static_cast<std::size_t>(edge.to)]);
    if (e.head<2>().norm() > kGate_m || std::abs(e[2]) > kGate_rad) continue;
    const Eigen::Matrix3d floor = Eigen::Vector3d(1e-2, 1e-2, 1e-1).asDiagonal();
    const Eigen::Matrix3d S = (edge.information + floor).inverse() + optimizer.marginal(graph, edge);
    const bool alone = friends[k].empty();
    const double limit = alone ? limit_alone : limit_in_pairs;
    // A gate as wide as a room would let a wrong loop pass by chance.
    if (alone && (limit * S.topLeftCorner<2, 2>().trace() > kGate_m * kGate_m || limit * S(2, 2) > kGate_rad * kGate_rad)) continue;
    if (e.dot(S.ldlt().solve(e)) < limit) allowed.push_back(k);
  }
  return allowed;
}

/// Optimises the believed edges and believes what agrees with the result, until nothing changes.
void settle(PoseGraph& graph, std::vector<bool>& believed, const RobustOptions& options, RobustResult& result) {
  for (int round = 0; round < kMaxRounds; ++round) {
    PoseGraph part = part_of(graph, believed);
    result.chi2_after = SparseOptimizer(part).optimize(part, options.optimize).chi2_after;
    graph.poses = std::move(part.poses);
    ++result.rounds;
    result.chi2_limit = fitted_limit(options.chi2_limit, loop_chi2(graph, believed), kAgreeMargin);
    std::vector<bool> next(believed);
    for (std::size_t k = 0; k < graph.edges.size(); ++k)
      if (is_loop(graph.edges[k])) next[k] = edge_chi2(graph.edges[k], graph.poses) < result.chi2_limit;
    if (next == believed) return;
    believed = std::move(next);
  }
}

}  // namespace

EdgeWeights graduate(PoseGraph& graph, double chi2_limit, const OptimizeOptions& options, int* rounds) {
  SparseOptimizer optimizer(graph);
  EdgeWeights weights(graph.edges.size(), 1.0);
  double mu = 0;
  for (int round = 0; round < kMaxGraduations; ++round) {
    optimizer.optimize(graph, options, weights);
    if (rounds) ++*rounds;
    std::vector<double> chi2(graph.edges.size(), 0.0);
    for (std::size_t k = 0; k < chi2.size(); ++k)
      if (is_loop(graph.edges[k])) chi2[k] = edge_chi2(graph.edges[k], graph.poses);
    if (round == 0) {
      const double worst = chi2.empty() ? 0.0 : *std::max_element(chi2.begin(), chi2.end());
      if (worst <= chi2_limit) return weights;
      mu = chi2_limit / (2 * worst - chi2_limit);
    }
    bool decided = true;
    for (std::size_t k = 0; k < chi2.size(); ++k) {
      if (!is_loop(graph.edges[k])) continue;
      // Yang et al., eq. 14.
      if (chi2[k] >= (mu + 1) / mu * chi2_limit)
        weights[k] = 0;
      else if (chi2[k] <= mu / (mu + 1) * chi2_limit)
        weights[k] = 1;
      else
        weights[k] = std::sqrt(chi2_limit * mu * (mu + 1) / chi2[k]) - mu;
      decided = decided && (weights[k] < 1e-3 || weights[k] > 1 - 1e-3);
    }
    if (decided && round > 0) break;
    mu *= 1.4;
  }
  for (double& weight : weights) weight = weight > 0.5 ? 1.0 : 0.0;
  return weights;
}

RobustResult optimize_robustly(PoseGraph& graph, const RobustOptions& options) {
  RobustResult result;
  const Friends friends = consistent_loops(graph, kReach, kRingChi2);
  std::vector<bool> believed = supported_loops(friends);
  result.supported = static_cast<std::size_t>(std::count(believed.begin(), believed.end(), true));
  if (result.supported == 0) believed.assign(graph.edges.size(), true);  // nothing to begin with: they have to sort it out
  for (std::size_t k = 0; k < graph.edges.size(); ++k)
    if (!is_loop(graph.edges[k])) believed[k] = true;

  PoseGraph part = part_of(graph, believed);
  SparseOptimizer(part).initialize_chordal(part);
  const EdgeWeights weights = graduate(part, options.chi2_limit, options.optimize, &result.rounds);
  for (std::size_t k = 0, at = 0; k < graph.edges.size(); ++k)
    if (believed[k]) believed[k] = weights[at++] > 0;

  part = part_of(graph, believed);
  SparseOptimizer(part).initialize_chordal(part);
  graph.poses = part.poses;
  settle(graph, believed, options, result);
  for (int round = 0; round < kMaxAdmissions; ++round) {
    const std::vector<std::size_t> allowed = allowed_loops(graph, believed, friends, options.chi2_limit);
    if (allowed.empty()) break;
    for (const std::size_t k : allowed) believed[k] = true;
    settle(graph, believed, options, result);
  }
  for (std::size_t k = 0; k < graph.edges.size(); ++k)
    if (!believed[k]) result.refused.push_back(k);
  return result;
}

}  // namespace modslam
