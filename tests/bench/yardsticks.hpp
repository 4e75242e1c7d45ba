// SPDX-License-Identifier: BSD-3-Clause
/// @file Other ways to optimise a pose graph, for comparison.
#pragma once
#include "common/graph/pose_graph.hpp"

namespace modslam::bench {

/// Ceres: Levenberg-Marquardt, sparse normal equations (SuiteSparse), one thread, derivatives by hand, its own stop rules.
/// @param seconds  CPU time of ceres::Solve alone, without making the problem.
OptimizeResult optimize_ceres(PoseGraph& graph, double& seconds);

/// Gauss-Newton as g2o has it: full steps, whatever they do to chi2; Eigen's sparse LDLT, its pattern analysed once.
OptimizeResult optimize_plain_gauss_newton(PoseGraph& graph, int max_iterations);

double cpu_seconds();

}  // namespace modslam::bench
