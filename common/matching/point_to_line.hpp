// SPDX-License-Identifier: BSD-3-Clause
/// @file Weighted point-to-line Gauss-Newton on SE(2), with information that only counts what the scan saw.
///
/// Residual of point k: e_k = n_k' (q_k - T p_k), q_k and n_k the nearest surface of the map, weight
/// 1 / v_k, v_k = n' (Q_point + Q_surface) n: noise across the surface only. Nothing is claimed along it;
/// that is what made Pfister's weights report millimetres in corridors (Pfister et al., ICRA 2002).
/// Noise of the normals leaks a little false information along the surface: S = sum A_k' (t t' s_n^2 / v_k) A_k
/// is taken off again, and the weakest direction of what is left decides about DEGENERATE.
#pragma once
#include "common/matching/submap.hpp"

namespace modslam {

struct RefineOptions {
  double gate_start_m = 0.5;   ///< a point farther from every surface has no partner, at first
  double gate_end_m = 0.12;    ///< and at the end
  double robust_m = 0.04;      ///< residual at which the Cauchy kernel halves a point's weight
  double model_sigma_m = 0.01; ///< what maps and beams are wrong by beyond range noise (bias, rough surfaces)
  int max_iterations = 20;
  Eigen::Matrix3d prior_information = Eigen::Matrix3d::Zero();  ///< of the guess, order x y heading, map frame
};

struct RefineResult {
  Pose2 T_map_base;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();           ///< laser alone, H - S, map frame
  Eigen::Matrix3d spurious = Eigen::Matrix3d::Zero();              ///< S
  double chi2 = 0;       ///< reduced, without the robust weights, over the inliers
  double overlap = 0;    ///< share of the points with a normal that have a partner within gate_end_m
  double normal_ratio = 0;  ///< weaker over stronger second moment of the normals: 1 room, 0 corridor
  Eigen::Matrix2d normals_seen = Eigen::Matrix2d::Zero();     ///< sum n n' over the scan's points, map frame
  Eigen::Matrix2d normals_matched = Eigen::Matrix2d::Zero();  ///< and over those with a partner
  int pairs = 0;
  int iterations = 0;
  bool converged = false;
};

/// @param points robot frame. Cost O(points * iterations).
RefineResult refine(const std::vector<OrientedPoint>& points, const SurfaceSource& map, const Pose2& guess,
                    const RefineOptions& options);

}  // namespace modslam
