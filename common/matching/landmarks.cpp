// SPDX-License-Identifier: BSD-3-Clause
#include "common/matching/landmarks.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <bitset>
#include <cmath>

namespace modslam {
namespace {

constexpr double kRadius_m = 0.15;   // of a pile; points strewn evenly along a wall scatter by 0.087 m in it...
constexpr double kNarrow_m = 0.045;  // ...which is clearly more than this
constexpr int kFewestPoints = 8, kFewestKeyframes = 4;
constexpr int kStepsToMiddle = 2;        // from the point that was hit to the middle of its pile
constexpr double kFacesAlong = 0.5;      // cosine; what faces elsewhere says little of the direction in question
constexpr double kModelSigma_m = 0.015;  // an edge is met anywhere within a beam's width
constexpr double kRobust_m = 0.05;       // residual at which the Cauchy kernel halves a point's weight
constexpr double kMaxChi2 = 4.0;         // for each partner
constexpr int kFewestPartners = 3;
constexpr double kNarrowestGate_m = 0.06, kWidestGate_m = 0.15;
constexpr double kSweep_m = 0.8, kSweepStep_m = 0.05;  // how far off the guess may be; what is looked for on the way
constexpr double kAmbiguous = 0.6;                       // share of the partners that another place may find by chance
constexpr int kIterations = 5;
constexpr double kStop_m = 1e-4;

}  // namespace

Landmarks::Landmarks() : index_(kRadius_m) {}

void Landmarks::build(const std::vector<const Keyframe*>& keyframes) {
  std::vector<Point> all;
  int number = 0;
  for (const Keyframe* keyframe : keyframes) {
    const PointMover to_map(keyframe->T_map_base);
    for (const OrientedPoint& point : keyframe->points_base) all.push_back({to_map * point.p, number, !point.has_normal()});
    ++number;
  }
  index_.build(all);
}

std::optional<Eigen::Vector2d> Landmarks::nearest_isolated(const Eigen::Vector2d& p, double gate_m) const {
  std::optional<Eigen::Vector2d> nearest;
  double best_d2 = gate_m * gate_m;
  index_.for_points_around(p, static_cast<int>(std::ceil(gate_m / kRadius_m)), [&](std::size_t i) {
    const Point& point = index_.points()[i];
    const double d2 = (point.p - p).squaredNorm();
    if (!point.isolated || d2 >= best_d2) return;
    best_d2 = d2;
    nearest = point.p;
  });
  return nearest;
}

Pile Landmarks::gather(const Eigen::Vector2d& centre) const {
  Pile pile;
  std::uint64_t seen_by = 0;
  index_.for_points_around(centre, 1, [&](std::size_t i) {
    const Point& point = index_.points()[i];
    const Eigen::Vector2d d = point.p - centre;
    if (d.squaredNorm() > kRadius_m * kRadius_m) return;
    pile.mean += d;
    pile.scatter += d * d.transpose();
    ++pile.points;
    seen_by |= std::uint64_t{1} << (point.keyframe % 64);
  });
  if (pile.points == 0) return pile;
  pile.mean /= pile.points;
  pile.scatter = pile.scatter / pile.points - pile.mean * pile.mean.transpose();
  pile.mean += centre;
  pile.keyframes = static_cast<int>(std::bitset<64>(seen_by).count());
  return pile;
}

std::optional<Pile> Landmarks::pile_at(const Eigen::Vector2d& p, double gate_m) const {
  const std::optional<Eigen::Vector2d> nearest = nearest_isolated(p, gate_m);
  if (!nearest) return std::nullopt;
  Pile pile = gather(*nearest);
  for (int step = 0; step < kStepsToMiddle && pile.points > 0; ++step) pile = gather(pile.mean);
  if (pile.points < kFewestPoints || pile.keyframes < kFewestKeyframes) return std::nullopt;
  return pile;
}

namespace {

/// What the partners of a scan say of a shift along one direction.
struct Votes {
  double weight = 0, pull = 0, chi2 = 0;
  int partners = 0;
  /// Counts the narrow directions of a pile: along the others its points are strewn. @param p a
  /// point of the scan, map frame
  void add(const Pile& pile, const Eigen::Vector2d& p, const Eigen::Vector2d& along) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(pile.scatter);
    bool used = false;
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d n = axes.eigenvectors().col(axis);
      const double var = std::max(0.0, axes.eigenvalues()[axis]), J = n.dot(along);
      if (var > kNarrow_m * kNarrow_m || std::abs(J) < kFacesAlong) continue;
      const double e = n.dot(pile.mean - p), v = var * (1 + 1.0 / pile.points) + kModelSigma_m * kModelSigma_m, ratio = e / kRobust_m;
      const double w = 1 / (v * (1 + ratio * ratio));
      weight += w * J * J;
      pull += w * J * e;
      chi2 += e * e / v;
      used = true;
    }
    partners += used;
  }
  bool agree() const { return partners >= kFewestPartners && chi2 < kMaxChi2 * partners; }
};

/// The isolated points of a scan, map frame, and what they say if the scan is shifted.
class Sweep {
 public:
  Sweep(const std::vector<OrientedPoint>& points, const Landmarks& landmarks, const Pose2& T_map_base, const Eigen::Vector2d& along)
      : landmarks_(landmarks), along_(along) {
    const PointMover to_map(T_map_base);
    for (const OrientedPoint& point : points)
      if (!point.has_normal()) isolated_.push_back(to_map * point.p);
  }

  Votes at(double shift_m, double gate_m) const {
    Votes votes;
    for (const Eigen::Vector2d& isolated : isolated_) {
      const Eigen::Vector2d p = isolated + shift_m * along_;
      if (const std::optional<Pile> pile = landmarks_.pile_at(p, gate_m)) votes.add(*pile, p, along_);
    }
    return votes;
  }

  /// Whether another shift finds nearly as many partners: then the wheels may have slipped, and nobody knows.
  bool another_fits(double shift_m, int partners) const {
    for (double s = -kSweep_m; s <= kSweep_m; s += kSweepStep_m)
      if (std::abs(s - shift_m) > 2 * kSweepStep_m && at(s, kSweepStep_m).partners > kAmbiguous * partners) return true;
    return false;
  }

 private:
  const Landmarks& landmarks_;
  Eigen::Vector2d along_;
  std::vector<Eigen::Vector2d> isolated_;
};

}  // namespace

LandmarkFit fit_along(const std::vector<OrientedPoint>& points, const Landmarks& landmarks, const Pose2& T_map_base, const Eigen::Vector2d& along,
                      double sigma_m) {
  const double gate_m = std::clamp(3 * sigma_m, kNarrowestGate_m, kWidestGate_m), prior = 1 / (sigma_m * sigma_m);
  const Sweep sweep(points, landmarks, T_map_base, along);
  LandmarkFit fit;
  Votes votes;
  for (int k = 0; k < kIterations; ++k) {
    votes = sweep.at(fit.shift_m, gate_m);
    if (votes.partners == 0) return {};
    const double step_m = (votes.pull - prior * fit.shift_m) / (votes.weight + prior);
    fit.shift_m += step_m;
    if (std::abs(step_m) < kStop_m) break;
  }
  if (!votes.agree() || sweep.another_fits(fit.shift_m, sweep.at(fit.shift_m, kSweepStep_m).partners)) return {};
  fit.information = votes.weight;
  fit.points = votes.partners;
  return fit;
}

}  // namespace modslam
