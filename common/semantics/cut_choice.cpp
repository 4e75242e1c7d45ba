// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/cut_choice.hpp"

#include <algorithm>
#include <cmath>

#include "common/semantics/plan_index.hpp"

namespace modslam {
namespace {

using Vec = Eigen::Vector2d;

constexpr double kSameWay = 0.7;                       // |cos| of cuts that may be one opening

double side_of(const Vec& a, const Vec& b, const Vec& p) { return (b - a).x() * (p - a).y() - (b - a).y() * (p - a).x(); }

bool cross_each_other(const Opening& p, const Opening& q) {
  const Vec inward_p = 0.05 * (p.b - p.a).normalized(), inward_q = 0.05 * (q.b - q.a).normalized();
  const Vec pa = p.a + inward_p, pb = p.b - inward_p, qa = q.a + inward_q, qb = q.b - inward_q;
  return side_of(pa, pb, qa) * side_of(pa, pb, qb) < 0 && side_of(qa, qb, pa) * side_of(qa, qb, pb) < 0;
}

/// Cuts of one opening lie side by side or across each other.
bool same_opening(const Opening& p, const Opening& q) {
  if (cross_each_other(p, q)) return true;
  const double near = 0.5 * std::max(p.width_m(), q.width_m());
  return (p.centre() - q.centre()).norm() < near && std::abs((p.b - p.a).normalized().dot((q.b - q.a).normalized())) > kSameWay;
}

}  // namespace

std::vector<CutOpening> choose_cuts(const std::vector<Opening>& openings, const CutLimits& limits) {
  constexpr double kSquare_m = 3.5;
  std::vector<CutOpening> cuts;
  PlanIndex index(kSquare_m);
  for (const Opening& opening : openings) {
    if (!limits.take(opening)) continue;
    const std::vector<std::size_t> near = index.near(opening.a, opening.b, 0.5 * kSquare_m);
    if (std::any_of(near.begin(), near.end(), [&](std::size_t k) { return same_opening(cuts[k].opening, opening); })) continue;
    index.add(opening.a, opening.b, cuts.size());
    cuts.push_back({opening, 0, 0});
  }
  return cuts;
}

}  // namespace modslam
