// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/LU>

#include "common/graph/sparse_optimizer.hpp"

namespace modslam {
namespace {

using Complex = std::complex<double>;

double weight_of(const EdgeWeights& weights, std::size_t k) { return weights.empty() ? 1.0 : weights[k]; }

/// What an edge says of the heading when nothing is known of the position.
double heading_information(const Eigen::Matrix3d& information) {
  const Eigen::Matrix2d& P = information.topLeftCorner<2, 2>();
  const Eigen::Vector2d c = information.topRightCorner<2, 1>();
  const double determinant = P.determinant();
  if (determinant <= 1e-12 * P.trace() * P.trace()) return information(2, 2);
  const double explained = (P(1, 1) * c[0] * c[0] - 2 * P(0, 1) * c[0] * c[1] + P(0, 0) * c[1] * c[1]) / determinant;
  return std::max(information(2, 2) - explained, 0.0);
}

}  // namespace

void SparseOptimizer::initialize_chordal(PoseGraph& graph, const EdgeWeights& weights) {
  if (graph.poses.size() < 2) return;
  relax_headings(graph, weights);
  solve_positions(graph, weights);
}

/// Minimises sum w |u_to - z u_from|^2 over complex u, u of node 0 fixed; the heading is the argument of u.
void SparseOptimizer::relax_headings(PoseGraph& graph, const EdgeWeights& weights) const {
  BlockCholesky<Complex, 1> A(pattern_);
  BlockCholesky<Complex, 1>::Vector b = BlockCholesky<Complex, 1>::Vector::Zero(pattern_.variables());
  const Complex u_0 = std::polar(1.0, graph.poses[0].heading);
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    const GraphEdge& edge = graph.edges[k];
    const double w = weight_of(weights, k) * heading_information(edge.information);
    const Complex wz = std::polar(w, edge.T_from_to.heading);
    const auto [i, j] = links_[k];
    if (i >= 0) A.diagonal(i)(0) += w;
    if (j >= 0) A.diagonal(j)(0) += w;
    if (i < 0 && j >= 0) b[j] += wz * u_0;
    if (j < 0 && i >= 0) b[i] += std::conj(wz) * u_0;
    if (entries_[k] >= 0) A.add_below(entries_[k], Eigen::Matrix<Complex, 1, 1>(row_is_from_[k] ? -std::conj(wz) : -wz));
  }
  A.factorize(true);
  const auto u = A.solve(b);
  for (int v = 0; v < pattern_.variables(); ++v)
    if (std::abs(u[v]) > 1e-12) graph.poses[static_cast<std::size_t>(v) + 1].heading = std::arg(u[v]);
}

/// Minimises the cost over all positions while the headings stay.
void SparseOptimizer::solve_positions(PoseGraph& graph, const EdgeWeights& weights) const {
  BlockCholesky<double, 2> A(pattern_);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(2 * static_cast<Eigen::Index>(pattern_.variables()));
  const Eigen::Vector2d t_0 = graph.poses[0].translation();
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    const GraphEdge& edge = graph.edges[k];
    const Pose2 &from = graph.poses[static_cast<std::size_t>(edge.from)], &to = graph.poses[static_cast<std::size_t>(edge.to)];
    const double e_heading = wrap_angle(to.heading - from.heading - edge.T_from_to.heading);
    // The positional error is M (t_to - t_from) - M R_from t_z, its information P; c e_heading couples it with the heading's error.
    const Eigen::Matrix2d M = rotation(from.heading + edge.T_from_to.heading).transpose();
    const Eigen::Matrix2d MtP = weight_of(weights, k) * M.transpose() * edge.information.topLeftCorner<2, 2>(), W = MtP * M;
    const Eigen::Vector2d pull = W * rotation(from.heading) * edge.T_from_to.translation() -
                                 weight_of(weights, k) * e_heading * M.transpose() * edge.information.topRightCorner<2, 1>();
    const auto [i, j] = links_[k];
    const auto at = [](int v) { return 2 * static_cast<Eigen::Index>(v); };
    if (i >= 0) {
      A.diagonal(i) += W;
      b.segment<2>(at(i)) -= j < 0 ? Eigen::Vector2d(pull - W * t_0) : pull;
    }
    if (j >= 0) {
      A.diagonal(j) += W;
      b.segment<2>(at(j)) += i < 0 ? Eigen::Vector2d(pull + W * t_0) : pull;
    }
    if (entries_[k] >= 0) A.add_below(entries_[k], -W);
  }
  std::vector<bool> held(graph.poses.size());
  for (int v = 0; v < pattern_.variables(); ++v) held[static_cast<std::size_t>(v) + 1] = A.diagonal(v).trace() > 0;
  A.factorize(true);
  const Eigen::VectorXd t = A.solve(b);
  for (std::size_t k = 1; k < graph.poses.size(); ++k) {
    if (!held[k]) continue;
    const auto at = 2 * static_cast<Eigen::Index>(k - 1);
    graph.poses[k].x = t[at], graph.poses[k].y = t[at + 1];
  }
}

}  // namespace modslam
