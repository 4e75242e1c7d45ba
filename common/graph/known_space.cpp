// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/known_space.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace modslam {
namespace {

constexpr double kReach_m = 0.6, kReach_rad = 0.75;
constexpr double kLever_m = 0.5;
constexpr double kChi2_3dof_999 = 16.27;
constexpr double kUnseen = 1e-2;  // information filled in where a fix saw nothing: 10 m

Eigen::Matrix3d turned(double heading_rad) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.topLeftCorner<2, 2>() = rotation(heading_rad);
  return R;
}

}  // namespace

std::vector<NodeId> nodes_in_reach(const std::vector<Pose2>& T_map_node, const Pose2& T_map_base) {
  std::vector<std::pair<double, NodeId>> near;
  for (std::size_t k = 0; k < T_map_node.size(); ++k) {
    const Pose2& node = T_map_node[k];
    if (std::abs(node.x - T_map_base.x) > kReach_m || std::abs(node.y - T_map_base.y) > kReach_m) continue;
    const double d_m = distance(node, T_map_base), turn_rad = std::abs(wrap_angle(node.heading - T_map_base.heading));
    if (d_m <= kReach_m && turn_rad <= kReach_rad) near.emplace_back(d_m + kLever_m * turn_rad, static_cast<NodeId>(k));
  }
  std::sort(near.begin(), near.end());
  std::vector<NodeId> ids;
  for (const auto& [cost, id] : near) ids.push_back(id);
  return ids;
}

std::optional<Anchorage> combine(const Anchorage& expected, const AnchorFix& fix) {
  const Eigen::Matrix3d R = turned(fix.T_node_base.heading);
  const Eigen::Matrix3d information = R * fix.information * R.transpose();
  const Eigen::Matrix3d slack = Eigen::Vector3d(1e-6, 1e-6, 1e-7).asDiagonal();
  const Eigen::Matrix3d prior = (expected.covariance + slack).inverse();
  Eigen::Vector3d d = fix.T_node_base.vector() - expected.T_node_base.vector();
  d[2] = wrap_angle(d[2]);
  // Innovation in the directions that the fix saw: d' (P + information^-1)^-1 d without inverting what may be singular.
  const Eigen::Matrix3d posterior = (prior + information).inverse();
  const Eigen::Vector3d step = posterior * information * d;
  const double innovation = d.dot(information * d) - step.dot(information * d);
  if (!(innovation < kChi2_3dof_999)) return std::nullopt;
  const Eigen::Vector3d placed = expected.T_node_base.vector() + step;
  return Anchorage{expected.node, Pose2(placed.x(), placed.y(), wrap_angle(placed.z())), 0.5 * (posterior + posterior.transpose())};
}

GraphEdge passing_edge(const Anchorage& came, NodeId node, const AnchorFix& fix) {
  GraphEdge edge;
  edge.from = came.node;
  edge.to = node;
  edge.kind = EdgeKind::kLoop;
  const Pose2 T_base_node = fix.T_node_base.inverse();
  edge.T_from_to = came.T_node_base * T_base_node;
  // A fix errs in the robot's frame; seen from the node that is an error of the node's place, lever arm included.
  Eigen::Matrix3d J = Eigen::Matrix3d::Identity();
  J(0, 2) = -T_base_node.y;
  J(1, 2) = T_base_node.x;
  const Eigen::Matrix3d cov_fix = J * (fix.information + kUnseen * Eigen::Matrix3d::Identity()).inverse() * J.transpose();
  const Eigen::Matrix3d cov = compose_covariance(came.T_node_base, came.covariance, T_base_node, cov_fix);
  const Eigen::Matrix3d R = turned(edge.T_from_to.heading);
  const Eigen::Matrix3d information = R.transpose() * cov.inverse() * R;
  edge.information = 0.5 * (information + information.transpose());
  return edge;
}

}  // namespace modslam
