// SPDX-License-Identifier: BSD-3-Clause
/// @file Rigid motions of the plane, SE(2). T_a_b takes b coordinates to a: p_a = T_a_b * p_b.
#pragma once
#include <Eigen/Core>
#include <cmath>

namespace modslam {

constexpr double kPi = 3.14159265358979323846;

/// Wraps an angle to (-pi, pi].
inline double wrap_angle(double angle_rad) {
  const double wrapped = std::remainder(angle_rad, 2.0 * kPi);
  return wrapped <= -kPi ? wrapped + 2.0 * kPi : wrapped;
}

inline Eigen::Matrix2d rotation(double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return (Eigen::Matrix2d() << c, -s, s, c).finished();
}

/// Pose of frame b in frame a: translation [m] and heading [rad], counter-clockwise.
struct Pose2 {
  double x = 0, y = 0, heading = 0;

  Pose2() = default;
  Pose2(double x_m, double y_m, double heading_rad) : x(x_m), y(y_m), heading(heading_rad) {}
  explicit Pose2(const Eigen::Vector3d& v) : x(v[0]), y(v[1]), heading(v[2]) {}

  Eigen::Vector2d translation() const { return {x, y}; }
  Eigen::Vector3d vector() const { return {x, y, heading}; }

  Pose2 operator*(const Pose2& T_b_c) const {
    const double c = std::cos(heading), s = std::sin(heading);
    return {x + c * T_b_c.x - s * T_b_c.y, y + s * T_b_c.x + c * T_b_c.y,
            wrap_angle(heading + T_b_c.heading)};
  }
  Eigen::Vector2d operator*(const Eigen::Vector2d& p_b) const {
    const double c = std::cos(heading), s = std::sin(heading);
    return {x + c * p_b.x() - s * p_b.y(), y + s * p_b.x() + c * p_b.y()};
  }
  Pose2 inverse() const {
    const double c = std::cos(heading), s = std::sin(heading);
    return {-c * x - s * y, s * x - c * y, wrap_angle(-heading)};
  }
};

/// A pose that moves many points: its sine and cosine are computed once.
class PointMover {
 public:
  explicit PointMover(const Pose2& T_a_b) : R_(rotation(T_a_b.heading)), t_(T_a_b.translation()) {}
  Eigen::Vector2d operator*(const Eigen::Vector2d& p_b) const { return R_ * p_b + t_; }

 private:
  Eigen::Matrix2d R_;
  Eigen::Vector2d t_;
};

/// T_b_c of two poses in one frame: inverse(T_a_b) * T_a_c.
inline Pose2 between(const Pose2& T_a_b, const Pose2& T_a_c) { return T_a_b.inverse() * T_a_c; }

inline double distance(const Pose2& p, const Pose2& q) { return std::hypot(p.x - q.x, p.y - q.y); }

/// The pose a share `t` of the way from p (0) to q (1); heading along the shorter arc.
inline Pose2 interpolate(const Pose2& p, const Pose2& q, double t) {
  return {p.x + t * (q.x - p.x), p.y + t * (q.y - p.y),
          wrap_angle(p.heading + t * wrap_angle(q.heading - p.heading))};
}

/// Jacobian of A * B by B, both as (x, y, heading): 3x3.
inline Eigen::Matrix3d jacobian_right(const Pose2& A) {
  Eigen::Matrix3d J = Eigen::Matrix3d::Identity();
  J.topLeftCorner<2, 2>() = rotation(A.heading);
  return J;
}

/// Jacobian of A * B by A, both as (x, y, heading): 3x3.
inline Eigen::Matrix3d jacobian_left(const Pose2& A, const Pose2& B) {
  const double c = std::cos(A.heading), s = std::sin(A.heading);
  Eigen::Matrix3d J = Eigen::Matrix3d::Identity();
  J(0, 2) = -s * B.x - c * B.y;
  J(1, 2) = c * B.x - s * B.y;
  return J;
}

/// Covariance of A * B for independent errors, additive in (x, y, heading).
inline Eigen::Matrix3d compose_covariance(const Pose2& A, const Eigen::Matrix3d& cov_A,
                                          const Pose2& B, const Eigen::Matrix3d& cov_B) {
  const Eigen::Matrix3d JA = jacobian_left(A, B), JB = jacobian_right(A);
  return JA * cov_A * JA.transpose() + JB * cov_B * JB.transpose();
}

}  // namespace modslam
