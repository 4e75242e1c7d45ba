// SPDX-License-Identifier: BSD-3-Clause
#include <ceres/ceres.h>

#include <Eigen/Cholesky>

#include "tests/bench/yardsticks.hpp"

namespace modslam::bench {
namespace {

/// Error of an edge times a root of its information, with derivatives (see SparseOptimizer::linearize).
class EdgeCost : public ceres::SizedCostFunction<3, 3, 3> {
 public:
  explicit EdgeCost(const GraphEdge& edge) : T_(edge.T_from_to), root_(edge.information.llt().matrixU()) {}

  bool Evaluate(double const* const* poses, double* residual, double** jacobians) const override {
    const Eigen::Map<const Eigen::Vector3d> from(poses[0]), to(poses[1]);
    const Eigen::Vector2d d = to.head<2>() - from.head<2>();
    const Eigen::Matrix2d M = rotation(from[2] + T_.heading).transpose();
    Eigen::Vector3d e;
    e.head<2>() = M * d - rotation(T_.heading).transpose() * T_.translation();
    e[2] = wrap_angle(to[2] - from[2] - T_.heading);
    Eigen::Map<Eigen::Vector3d>(residual, 3) = root_ * e;
    using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    Eigen::Matrix3d B = Eigen::Matrix3d::Identity(), C = Eigen::Matrix3d::Identity();
    B.topLeftCorner<2, 2>() = M;
    C(0, 2) = -d.y(), C(1, 2) = d.x();
    if (jacobians && jacobians[0]) Eigen::Map<RowMajor>(jacobians[0], 3, 3) = -root_ * B * C;
    if (jacobians && jacobians[1]) Eigen::Map<RowMajor>(jacobians[1], 3, 3) = root_ * B;
    return true;
  }

 private:
  Pose2 T_;
  Eigen::Matrix3d root_;
};

}  // namespace

OptimizeResult optimize_ceres(PoseGraph& graph, double& seconds) {
  std::vector<Eigen::Vector3d> poses;
  for (const Pose2& pose : graph.poses) poses.push_back(pose.vector());
  ceres::Problem problem;
  for (const GraphEdge& edge : graph.edges)
    problem.AddResidualBlock(new EdgeCost(edge), nullptr, poses[static_cast<std::size_t>(edge.from)].data(),
                             poses[static_cast<std::size_t>(edge.to)].data());
  problem.SetParameterBlockConstant(poses[0].data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.num_threads = 1;
  options.max_num_iterations = 100;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  OptimizeResult result;
  result.chi2_before = graph_chi2(graph);
  const double before = cpu_seconds();
  ceres::Solve(options, &problem, &summary);
  seconds = cpu_seconds() - before;
  for (std::size_t k = 0; k < poses.size(); ++k) graph.poses[k] = Pose2(poses[k][0], poses[k][1], wrap_angle(poses[k][2]));
  result.chi2_after = graph_chi2(graph);
  result.iterations = summary.num_successful_steps;
  return result;
}

}  // namespace modslam::bench
