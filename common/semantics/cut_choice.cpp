// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/cut_choice.hpp"

#include <algorithm>
#include <cmath>

namespace modslam {
namespace {

using Vec = Eigen::Vector2d;

constexpr double kSameWay = 0.7;  // |cos| of cuts that may be one opening

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

std::size_t CutChoice::take(const Opening& opening) {
  if (free_.empty()) {
    free_.push_back(slots_.size());
    slots_.emplace_back();
  }
  const std::size_t slot = free_.back();
  free_.pop_back();
  slots_[slot] = {opening, false};
  index_.add(opening.a, opening.b, slot);
  return slot;
}

void CutChoice::drop(std::size_t slot) {
  const Opening& opening = slots_[slot].opening;
  if (slots_[slot].chosen) stirred_.push_back({opening.centre(), 0.5 * opening.width_m()});
  index_.remove(opening.a, opening.b, slot);
  free_.push_back(slot);
}

/// Openings whose middles are farther apart than half of both their widths have nothing to do with each other.
bool CutChoice::is_stirred(const Opening& opening) const {
  if (stirred_.empty()) return false;
  const Vec centre = opening.centre();
  const double half_m = 0.5 * opening.width_m() + 0.01;
  return std::any_of(stirred_.begin(), stirred_.end(), [&](const Stirred& other) {
    const double reach_m = half_m + other.half_m;
    return (centre - other.centre).squaredNorm() < reach_m * reach_m;
  });
}

void CutChoice::choose(std::size_t slot) {
  Slot& asked = slots_[slot];
  const std::vector<std::size_t> near = index_.near(asked.opening.a, asked.opening.b, 0.5 * kSquare_m);
  const bool chosen = std::none_of(near.begin(), near.end(), [&](std::size_t k) {
    return slots_[k].chosen && slots_[k].order() < asked.order() && same_opening(slots_[k].opening, asked.opening);
  });
  if (chosen != asked.chosen) stirred_.push_back({asked.opening.centre(), 0.5 * asked.opening.width_m()});
  asked.chosen = chosen;
}

const std::vector<std::size_t>& CutChoice::update(const std::vector<Opening>& openings) {
  stirred_.clear();
  chosen_.clear();
  std::vector<std::size_t> listed;
  listed.reserve(openings.size());
  auto before = listed_.begin();
  for (std::size_t k = 0; k < openings.size(); ++k) {
    const auto order = Slot{openings[k], false}.order();
    for (; before != listed_.end() && slots_[*before].order() < order; ++before) drop(*before);
    const bool known = before != listed_.end() && slots_[*before].order() == order;
    listed.push_back(known ? *before++ : take(openings[k]));
    slots_[listed.back()].opening = openings[k];
    if (!known || is_stirred(openings[k])) choose(listed.back());
    if (slots_[listed.back()].chosen) chosen_.push_back(k);
  }
  for (; before != listed_.end(); ++before) drop(*before);
  listed_ = std::move(listed);
  return chosen_;
}

}  // namespace modslam
