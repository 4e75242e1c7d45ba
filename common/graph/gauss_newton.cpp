// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <cmath>

#include "common/graph/pose_graph.hpp"

namespace modslam {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

/// Weight of an edge under dynamic covariance scaling; 1 for sequence edges.
double kernel_weight(const GraphEdge& edge, double chi2, double phi) {
  if (phi <= 0 || edge.kind != EdgeKind::kLoop) return 1.0;
  const double s = std::min(1.0, 2 * phi / (phi + chi2));
  return s * s;
}

double robust_chi2(const PoseGraph& graph, double phi) {
  double sum = 0;
  for (const GraphEdge& edge : graph.edges) {
    const double chi2 = edge_chi2(edge, graph.poses), weight = kernel_weight(edge, chi2, phi);
    const double s = std::sqrt(weight);
    sum += weight * chi2 + (weight < 1 ? phi * (1 - s) * (1 - s) : 0.0);
  }
  return sum;
}

/// Jacobians of the edge error by the two poses (x, y, heading in the map frame).
void jacobians(const GraphEdge& edge, const Pose2& from, const Pose2& to, Eigen::Matrix3d& A, Eigen::Matrix3d& B) {
  const Eigen::Matrix2d R_from = rotation(from.heading), R_z = rotation(edge.T_from_to.heading);
  const Eigen::Vector2d d = to.translation() - from.translation();
  const Eigen::Matrix2d M = R_z.transpose() * R_from.transpose();
  // d/dheading of R(heading)' d = R' J' d with J = [0 -1; 1 0]
  const Eigen::Vector2d Jt_d(d.y(), -d.x());
  A.setZero();
  A.topLeftCorner<2, 2>() = -M;
  A.topRightCorner<2, 1>() = M * Jt_d;
  A(2, 2) = -1;
  B.setZero();
  B.topLeftCorner<2, 2>() = M;
  B(2, 2) = 1;
}

/// Gauss-Newton system H step = -g; node 0 is left out. Only the lower triangle of H is filled.
void assemble(const PoseGraph& graph, double phi, Sparse& H, Eigen::VectorXd& g) {
  const auto n = static_cast<Eigen::Index>(3 * (graph.poses.size() - 1));
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(graph.edges.size() * 27 + static_cast<std::size_t>(n));
  g = Eigen::VectorXd::Zero(n);
  const auto add = [&](Eigen::Index row, Eigen::Index col, const Eigen::Matrix3d& block) {
    if (row < 0 || col < 0 || row < col) return;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c)
        if (row + r >= col + c) entries.emplace_back(static_cast<int>(row + r), static_cast<int>(col + c), block(r, c));
  };
  for (const GraphEdge& edge : graph.edges) {
    const Pose2& from = graph.poses[static_cast<std::size_t>(edge.from)];
    const Pose2& to = graph.poses[static_cast<std::size_t>(edge.to)];
    const Eigen::Vector3d e = edge_error(edge, from, to);
    const double weight = kernel_weight(edge, e.dot(edge.information * e), phi);
    const Eigen::Matrix3d W = weight * edge.information;
    Eigen::Matrix3d A, B;
    jacobians(edge, from, to, A, B);
    const Eigen::Index i = 3 * (edge.from - 1), j = 3 * (edge.to - 1);
    add(i, i, A.transpose() * W * A);
    add(j, j, B.transpose() * W * B);
    add(i, j, A.transpose() * W * B);
    add(j, i, B.transpose() * W * A);
    if (i >= 0) g.segment<3>(i) += A.transpose() * W * e;
    if (j >= 0) g.segment<3>(j) += B.transpose() * W * e;
  }
  for (Eigen::Index k = 0; k < n; ++k) entries.emplace_back(static_cast<int>(k), static_cast<int>(k), 1e-9);
  H.resize(n, n);
  H.setFromTriplets(entries.begin(), entries.end());
}

std::vector<Pose2> moved(const std::vector<Pose2>& poses, const Eigen::VectorXd& step, double share) {
  std::vector<Pose2> out = poses;
  for (std::size_t k = 1; k < out.size(); ++k) {
    const Eigen::Vector3d d = share * step.segment<3>(static_cast<Eigen::Index>(3 * (k - 1)));
    out[k] = {out[k].x + d[0], out[k].y + d[1], wrap_angle(out[k].heading + d[2])};
  }
  return out;
}

}  // namespace

double graph_chi2(const PoseGraph& graph) {
  double sum = 0;
  for (const GraphEdge& edge : graph.edges) sum += edge_chi2(edge, graph.poses);
  return sum;
}

OptimizeResult optimize_gauss_newton(PoseGraph& graph, const OptimizeOptions& options) {
  OptimizeResult result;
  double error = robust_chi2(graph, options.dcs_phi);
  result.chi2_before = result.chi2_after = error;
  if (graph.poses.size() < 2 || graph.edges.empty()) return result;

  Eigen::SimplicialLDLT<Sparse> solver;
  Sparse H;
  Eigen::VectorXd g;
  for (int k = 0; k < options.max_iterations; ++k) {
    assemble(graph, options.dcs_phi, H, g);
    if (k == 0) solver.analyzePattern(H);
    solver.factorize(H);
    if (solver.info() != Eigen::Success) {
      result.solved = k > 0;
      break;
    }
    const Eigen::VectorXd step = -solver.solve(g);
    ++result.iterations;
    double share = 1.0, next_error = 0;
    std::vector<Pose2> next;
    for (int halvings = 0; halvings < 6; ++halvings, share /= 2) {
      next = moved(graph.poses, step, share);
      std::swap(next, graph.poses);
      next_error = robust_chi2(graph, options.dcs_phi);
      std::swap(next, graph.poses);
      if (next_error <= error) break;
    }
    if (!(next_error <= error)) break;  // no step along this direction helps: a minimum within rounding
    graph.poses = std::move(next);
    const bool settled = error - next_error <= options.stop_relative * (error + 1e-12);
    error = next_error;
    if (settled) break;
  }
  result.chi2_after = error;
  return result;
}

void initialize_from_tree(PoseGraph& graph) {
  std::vector<std::vector<std::size_t>> edges_at(graph.poses.size());
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    edges_at[static_cast<std::size_t>(graph.edges[k].from)].push_back(k);
    edges_at[static_cast<std::size_t>(graph.edges[k].to)].push_back(k);
  }
  std::vector<bool> placed(graph.poses.size(), false);
  std::vector<std::size_t> queue{0};
  placed[0] = true;
  for (std::size_t head = 0; head < queue.size(); ++head) {
    const std::size_t at = queue[head];
    for (const std::size_t k : edges_at[at]) {
      const GraphEdge& edge = graph.edges[k];
      const bool forward = static_cast<std::size_t>(edge.from) == at;
      const auto other = static_cast<std::size_t>(forward ? edge.to : edge.from);
      if (placed[other]) continue;
      graph.poses[other] = graph.poses[at] * (forward ? edge.T_from_to : edge.T_from_to.inverse());
      placed[other] = true;
      queue.push_back(other);
    }
  }
}

}  // namespace modslam
