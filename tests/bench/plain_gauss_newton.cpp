// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <cmath>
#include <ctime>

#include "tests/bench/yardsticks.hpp"

namespace modslam::bench {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

void assemble(const PoseGraph& graph, Sparse& H, Eigen::VectorXd& g) {
  const auto n = static_cast<Eigen::Index>(3 * (graph.poses.size() - 1));
  std::vector<Eigen::Triplet<double>> entries;
  g = Eigen::VectorXd::Zero(n);
  const auto add = [&](Eigen::Index row, Eigen::Index column, const Eigen::Matrix3d& block) {
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c)
        if (row >= 0 && column >= 0 && row + r >= column + c)
          entries.emplace_back(static_cast<int>(row + r), static_cast<int>(column + c), block(r, c));
  };
  for (const GraphEdge& edge : graph.edges) {
    const Pose2 &from = graph.poses[static_cast<std::size_t>(edge.from)], &to = graph.poses[static_cast<std::size_t>(edge.to)];
    const Eigen::Vector2d d = to.translation() - from.translation();
    Eigen::Matrix3d B = Eigen::Matrix3d::Identity(), C = Eigen::Matrix3d::Identity();
    B.topLeftCorner<2, 2>() = rotation(from.heading + edge.T_from_to.heading).transpose();
    C(0, 2) = -d.y(), C(1, 2) = d.x();
    const Eigen::Matrix3d A = -B * C;
    const Eigen::Vector3d We = edge.information * edge_error(edge, from, to);
    const Eigen::Index i = 3 * (edge.from - 1), j = 3 * (edge.to - 1);
    add(i, i, A.transpose() * edge.information * A);
    add(j, j, B.transpose() * edge.information * B);
    add(i, j, A.transpose() * edge.information * B);
    add(j, i, B.transpose() * edge.information * A);
    if (i >= 0) g.segment<3>(i) += A.transpose() * We;
    if (j >= 0) g.segment<3>(j) += B.transpose() * We;
  }
  H.resize(n, n);
  H.setFromTriplets(entries.begin(), entries.end());
}

}  // namespace

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec) * 1e-9;
}

OptimizeResult optimize_plain_gauss_newton(PoseGraph& graph, int max_iterations) {
  OptimizeResult result;
  double chi2 = result.chi2_before = graph_chi2(graph);
  Eigen::SimplicialLDLT<Sparse> solver;
  Sparse H;
  Eigen::VectorXd g;
  while (result.iterations < max_iterations) {
    assemble(graph, H, g);
    if (result.iterations == 0) solver.analyzePattern(H);
    solver.factorize(H);
    const Eigen::VectorXd step = -solver.solve(g);
    for (std::size_t k = 1; k < graph.poses.size(); ++k) {
      Pose2& pose = graph.poses[k];
      const Eigen::Vector3d d = step.segment<3>(static_cast<Eigen::Index>(3 * (k - 1)));
      pose = {pose.x + d[0], pose.y + d[1], wrap_angle(pose.heading + d[2])};
    }
    ++result.iterations;
    const double next = graph_chi2(graph);
    const bool settled = std::abs(chi2 - next) <= 1e-6 * chi2;
    chi2 = next;
    if (settled || !std::isfinite(chi2)) break;
  }
  result.chi2_after = chi2;
  return result;
}

}  // namespace modslam::bench
