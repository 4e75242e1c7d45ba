// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/relative_covariance.hpp"

#include <Eigen/LU>
#include <queue>

namespace modslam {

Eigen::Matrix3d edge_covariance_from(const GraphEdge& edge) {
  const Eigen::Matrix3d floor = Eigen::Vector3d(1e-2, 1e-2, 1e-1).asDiagonal();  // 10 m, 3 rad
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.topLeftCorner<2, 2>() = rotation(edge.T_from_to.heading);
  return R * (edge.information + floor).inverse() * R.transpose();
}

RelativeCovariance::RelativeCovariance(const std::vector<Pose2>& poses, const std::vector<const GraphEdge*>& edges,
                                       NodeId source) {
  constexpr double kUnreached = 1e6;
  covariance_.assign(poses.size(), kUnreached * Eigen::Matrix3d::Identity());
  std::vector<std::vector<const GraphEdge*>> edges_at(poses.size());
  for (const GraphEdge* edge : edges) {
    edges_at[static_cast<std::size_t>(edge->from)].push_back(edge);
    edges_at[static_cast<std::size_t>(edge->to)].push_back(edge);
  }
  using Item = std::pair<double, NodeId>;
  std::priority_queue<Item, std::vector<Item>, std::greater<Item>> open;
  std::vector<bool> done(poses.size(), false);
  std::vector<double> best(poses.size(), kUnreached);
  covariance_[static_cast<std::size_t>(source)].setZero();
  open.push({0.0, source});
  while (!open.empty()) {
    const auto at = static_cast<std::size_t>(open.top().second);
    open.pop();
    if (done[at]) continue;
    done[at] = true;
    const Pose2 T_source_at = between(poses[static_cast<std::size_t>(source)], poses[at]);
    for (const GraphEdge* edge : edges_at[at]) {
      const bool forward = static_cast<std::size_t>(edge->from) == at;
      const auto other = static_cast<std::size_t>(forward ? edge->to : edge->from);
      if (done[other]) continue;
      Eigen::Matrix3d cov_step = edge_covariance_from(*edge);
      const Pose2 T_at_other = between(poses[at], poses[other]);
      if (!forward) {
        // The edge errs in the frame of `other`. d inverse(T) = -[R' (dt - J t dheading), dheading], and for t = R' t of the
        // inverse that is, up to the common sign, [R_at_other dt + (y, -x) of T_at_other dheading, dheading].
        Eigen::Matrix3d J = Eigen::Matrix3d::Identity();
        J.topLeftCorner<2, 2>() = rotation(T_at_other.heading);
        J(0, 2) = -T_at_other.y;
        J(1, 2) = T_at_other.x;
        cov_step = J * cov_step * J.transpose();
      }
      const Eigen::Matrix3d cov = compose_covariance(T_source_at, covariance_[at], T_at_other, cov_step);
      const double size = cov(0, 0) + cov(1, 1);
      if (size >= best[other]) continue;
      best[other] = size;
      covariance_[other] = cov;
      open.push({size, static_cast<NodeId>(other)});
    }
  }
}

}  // namespace modslam
