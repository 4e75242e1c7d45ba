// SPDX-License-Identifier: BSD-3-Clause
/// @file The simulated robot's body and drive: about a Pioneer, the platform of most indoor logs.
#pragma once

namespace modslam {

inline constexpr double kRobotRadius_m = 0.27;
inline constexpr double kMaxAcceleration = 0.5;     ///< [m/s^2]
inline constexpr double kMaxYawRate = 0.8;          ///< [rad/s]
inline constexpr double kMaxYawAcceleration = 4.0;  ///< [rad/s^2]

}  // namespace modslam
