// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/sparse_optimizer.hpp"

#include <algorithm>
#include <utility>

namespace modslam {
namespace {

constexpr double kRidge = 1e-9;  // keeps a direction that nothing holds where it is

std::vector<BlockPattern::Link> links_of(const PoseGraph& graph) {
  std::vector<BlockPattern::Link> links;
  links.reserve(graph.edges.size());
  for (const GraphEdge& edge : graph.edges) links.emplace_back(static_cast<int>(edge.from) - 1, static_cast<int>(edge.to) - 1);
  return links;
}

/// Dynamic covariance scaling: the weight of a loop edge, and what its cost becomes.
struct Kernel {
  double weight = 1, cost;
  Kernel(const GraphEdge& edge, double chi2, double phi) : cost(chi2) {
    if (phi <= 0 || edge.kind != EdgeKind::kLoop || chi2 <= phi) return;
    const double s = 2 * phi / (phi + chi2);
    weight = s * s;
    cost = weight * chi2 + phi * (1 - s) * (1 - s);
  }
};

double weight_of(const EdgeWeights& weights, std::size_t k) { return weights.empty() ? 1.0 : weights[k]; }

std::vector<Pose2> moved(const std::vector<Pose2>& poses, const Eigen::VectorXd& step) {
  std::vector<Pose2> out = poses;
  for (std::size_t k = 1; k < out.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(3 * (k - 1));
    out[k] = {out[k].x + step[at], out[k].y + step[at + 1], wrap_angle(out[k].heading + step[at + 2])};
  }
  return out;
}

double total_chi2(const PoseGraph& graph, double dcs_phi, const EdgeWeights& weights) {
  double sum = 0;
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    const double weight = weight_of(weights, k);
    if (weight > 0) sum += weight * Kernel(graph.edges[k], edge_chi2(graph.edges[k], graph.poses), dcs_phi).cost;
  }
  return sum;
}

}  // namespace

SparseOptimizer::SparseOptimizer(const PoseGraph& graph)
    : links_(links_of(graph)), pattern_(static_cast<int>(graph.poses.size()) - (graph.poses.empty() ? 0 : 1), links_), H_(pattern_) {
  for (const auto& [from, to] : links_) {
    const bool inner = from >= 0 && to >= 0 && from != to;
    const int p = inner ? pattern_.place(from) : 0, q = inner ? pattern_.place(to) : 0;
    entries_.push_back(inner ? pattern_.entry(std::max(p, q), std::min(p, q)) : -1);
    row_is_from_.push_back(p > q);
  }
}

/// Fills H_ and gradient_ (half the gradient of the cost). With M = R_z' R_from' and d = t_to - t_from the error's derivatives are
/// A = [-M, M J' d; 0, -1] by `from` and B = [M, 0; 0, 1] by `to`, J a quarter turn; A = -B C with C = [I, -J' d; 0, 1].
/// @return the cost.
double SparseOptimizer::linearize(const PoseGraph& graph, double dcs_phi, const EdgeWeights& weights, double damping) {
  H_.clear();
  gradient_.setZero(3 * static_cast<Eigen::Index>(pattern_.variables()));
  double cost = 0;
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    const GraphEdge& edge = graph.edges[k];
    double weight = weight_of(weights, k);
    if (!(weight > 0)) continue;
    const Pose2 &from = graph.poses[static_cast<std::size_t>(edge.from)], &to = graph.poses[static_cast<std::size_t>(edge.to)];
    const Eigen::Matrix2d M = rotation(from.heading + edge.T_from_to.heading).transpose();
    const Eigen::Vector2d d = to.translation() - from.translation();
    Eigen::Vector3d e;
    e.head<2>() = M * d - rotation(edge.T_from_to.heading).transpose() * edge.T_from_to.translation();
    e[2] = wrap_angle(to.heading - from.heading - edge.T_from_to.heading);
    const Kernel kernel(edge, e.dot(edge.information * e), dcs_phi);
    cost += weight * kernel.cost;
    weight *= kernel.weight;

    Eigen::Matrix3d B = Eigen::Matrix3d::Identity(), C = Eigen::Matrix3d::Identity();
    B.topLeftCorner<2, 2>() = M;
    C(0, 2) = -d.y(), C(1, 2) = d.x();
    const Eigen::Matrix3d BtW = weight * B.transpose() * edge.information, H_to = BtW * B, H_to_C = H_to * C;
    const Eigen::Vector3d g_to = BtW * e;
    const auto [i, j] = links_[k];
    if (j >= 0) {
      H_.diagonal(j) += H_to;
      gradient_.segment<3>(3 * static_cast<Eigen::Index>(j)) += g_to;
    }
    if (i >= 0) {
      H_.diagonal(i) += C.transpose() * H_to_C;
      gradient_.segment<3>(3 * static_cast<Eigen::Index>(i)) -= C.transpose() * g_to;
    }
    if (entries_[k] < 0) continue;
    if (row_is_from_[k])
      H_.add_below(entries_[k], -H_to_C.transpose());
    else
      H_.add_below(entries_[k], -H_to_C);
  }
  for (int v = 0; v < pattern_.variables(); ++v) {
    H_.diagonal(v).diagonal() *= 1 + damping;
    H_.diagonal(v).diagonal().array() += kRidge;
  }
  return cost;
}

void SparseOptimizer::prepare_marginals(const PoseGraph& graph, const EdgeWeights& weights) {
  linearize(graph, 0.0, weights, 0.0);
  H_.factorize(true);
}

Eigen::Matrix3d SparseOptimizer::marginal(const PoseGraph& graph, const GraphEdge& edge) const {
  const Pose2 &from = graph.poses[static_cast<std::size_t>(edge.from)], &to = graph.poses[static_cast<std::size_t>(edge.to)];
  const Eigen::Vector2d d = to.translation() - from.translation();
  Eigen::Matrix3d B = Eigen::Matrix3d::Identity(), C = Eigen::Matrix3d::Identity();  // as in linearize()
  B.topLeftCorner<2, 2>() = rotation(from.heading + edge.T_from_to.heading).transpose();
  C(0, 2) = -d.y(), C(1, 2) = d.x();
  const Eigen::Matrix3d A = -B * C;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::VectorXd b = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(pattern_.variables()));
    if (edge.from > 0) b.segment<3>(3 * (edge.from - 1)) += A.row(axis).transpose();
    if (edge.to > 0) b.segment<3>(3 * (edge.to - 1)) += B.row(axis).transpose();
    const Eigen::VectorXd x = H_.solve(b);
    if (edge.from > 0) covariance.col(axis) += A * x.segment<3>(3 * (edge.from - 1));
    if (edge.to > 0) covariance.col(axis) += B * x.segment<3>(3 * (edge.to - 1));
  }
  return 0.5 * (covariance + covariance.transpose());
}

std::vector<Eigen::Matrix3d> SparseOptimizer::marginals() const {
  std::vector<Eigen::Matrix3d> covariances = H_.inverse_diagonal();
  covariances.insert(covariances.begin(), Eigen::Matrix3d::Zero());
  return covariances;
}

OptimizeResult SparseOptimizer::optimize(PoseGraph& graph, const OptimizeOptions& options, const EdgeWeights& weights) {
  OptimizeResult result;
  if (graph.poses.size() < 2 || graph.edges.empty()) return result;
  double damping = 0, cost = linearize(graph, options.dcs_phi, weights, damping);
  result.chi2_before = cost;
  for (int tries = 0; result.iterations < options.max_iterations && tries < 4 * options.max_iterations; ++tries) {
    H_.factorize(true);
    const Eigen::VectorXd step = -H_.solve(gradient_);
    const double promised = -step.dot(gradient_);  // of a quadratic cost, at full length
    std::vector<Pose2> last = std::exchange(graph.poses, moved(graph.poses, step));
    const bool is_last = promised <= options.stop_relative * (cost + 1e-12);
    double next = is_last ? total_chi2(graph, options.dcs_phi, weights) : linearize(graph, options.dcs_phi, weights, damping);
    if (!(next <= cost) && !is_last && options.dcs_phi <= 0) {
      // Far turns bend straight steps of the positions. Positions that fit the new headings are a linear problem.
      solve_positions(graph, weights);
      next = linearize(graph, options.dcs_phi, weights, damping);
    }
    if (!(next <= cost)) {
      graph.poses = std::move(last);
      if (is_last) break;  // a minimum within rounding
      damping = std::max(1e-4, 10 * damping);
      if (damping > 1e8) break;
      linearize(graph, options.dcs_phi, weights, damping);
      continue;
    }
    ++result.iterations;
    const bool settled = is_last || (damping == 0 && cost - next <= options.stop_relative * (cost + 1e-12));
    cost = next;
    if (settled) break;
    if (damping > 0) {
      damping = damping < 1e-6 ? 0 : damping / 10;
      linearize(graph, options.dcs_phi, weights, damping);
    }
  }
  result.chi2_after = cost;
  return result;
}

}  // namespace modslam
