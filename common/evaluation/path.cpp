// SPDX-License-Identifier: BSD-3-Clause
#include "common/evaluation/path.hpp"

#include <stdexcept>

#include "common/formats/text_fields.hpp"

namespace modslam {
namespace {

StampedPose parse_pose(std::string_view line) {
  TextFields fields(line);
  fields.expect_left(8);
  StampedPose pose;
  pose.stamp_s = fields.number("the stamp");
  pose.pose.x = fields.number("x", 1e6);
  pose.pose.y = fields.number("y", 1e6);
  fields.number("z");
  const double qx = fields.number("qx", 2), qy = fields.number("qy", 2),
               qz = fields.number("qz", 2), qw = fields.number("qw", 2);
  if (std::abs(qx * qx + qy * qy + qz * qz + qw * qw - 1) > 0.05)
    throw BadLine("has no unit quaternion");
  pose.pose.heading = std::atan2(2 * (qw * qz + qx * qy), 1 - 2 * (qy * qy + qz * qz));
  return pose;
}

}  // namespace

Path parse_tum(std::string_view text) {
  Path path;
  for_each_line(text, [&](std::size_t number, std::string_view line) {
    if (line.front() == '#') return;
    try {
      path.push_back(parse_pose(line));
    } catch (const BadLine& bad) {
      throw std::runtime_error("line " + std::to_string(number) + " " + bad.what());
    }
  });
  if (path.empty()) throw std::runtime_error("holds no pose");
  return path;
}

}  // namespace modslam
