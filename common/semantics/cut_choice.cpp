// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/cut_choice.hpp"

#include <algorithm>
#include <cmath>

namespace modslam {
namespace {

using Vec = Eigen::Vector2d;

constexpr double kSameWay = 0.7;  // |cos| of cuts that may be one opening

double side_of(const Vec& a, const Vec& b, const Vec& p) { return (b - a).x() * (p - a).y() - (b - a).y() * (p - a).x(); }

bool cross_each_other(const Gap& p, const Gap& q) {
  const Vec inward_p = 0.05 * (p.b - p.a).normalized(), inward_q = 0.05 * (q.b - q.a).normalized();
  const Vec pa = p.a + inward_p, pb = p.b - inward_p, qa = q.a + inward_q, qb = q.b - inward_q;
  return side_of(pa, pb, qa) * side_of(pa, pb, qb) < 0 && side_of(qa, qb, pa) * side_of(qa, qb, pb) < 0;
}

/// Cuts of one opening lie side by side or across each other.
bool same_opening(const Gap& p, const Gap& q) {
  if (cross_each_other(p, q)) return true;
  const double near = 0.5 * std::max(p.width_m(), q.width_m());
  return (p.centre() - q.centre()).norm() < near && std::abs((p.b - p.a).normalized().dot((q.b - q.a).normalized())) > kSameWay;
}

}  // namespace

std::size_t CutChoice::find(const Gap& gap) const {
  std::size_t found = slots_.end();
  index_.each_near(gap.a, gap.b, 0, [&](std::size_t k) {
    if (slots_[k].gap.order() == gap.order()) found = k;
  });
  return found;
}

/// Gaps farther apart than half of the wider one's width have nothing to do with each other.
void CutChoice::ask_less_sure(std::size_t number, Queue& queue) const {
  const Gap& gap = slots_[number].gap;
  const Order order = gap.order();
  index_.each_near(gap.a, gap.b, kReach_m, [&](std::size_t k) {
    if (const Order other = slots_[k].gap.order(); order < other && same_opening(gap, slots_[k].gap)) queue.emplace(other, k);
  });
}

bool CutChoice::is_best(std::size_t number) const {
  const Gap& gap = slots_[number].gap;
  bool best = true;
  index_.each_near(gap.a, gap.b, kReach_m, [&](std::size_t k) {
    best = best && !(slots_[k].chosen && slots_[k].gap.order() < gap.order() && same_opening(slots_[k].gap, gap));
  });
  return best;
}

Numbers::iterator CutChoice::place_of(std::size_t number) {
  const auto order = [&](std::size_t k) { return std::pair(slots_[k].gap.order(), k); };
  return std::lower_bound(chosen_.begin(), chosen_.end(), number, [&](std::size_t p, std::size_t q) { return order(p) < order(q); });
}

NumberNews CutChoice::update(const GapNews& news) {
  slots_.next_round();
  NumberNews change;
  Numbers gone;
  for (const Gap& gap : news.gone) {
    const std::size_t number = find(gap);
    if (number == slots_.end()) continue;
    index_.remove_line(gap.a, gap.b, number);
    slots_.give_back(number);
    gone.push_back(number);
  }
  Queue queue;
  for (const std::size_t number : gone)
    if (std::exchange(slots_[number].chosen, false)) {
      change.gone.push_back(number);
      ask_less_sure(number, queue);
    }
  for (const Gap& gap : news.come) {
    const std::size_t number = slots_.take({gap, false});
    index_.add_line(gap.a, gap.b, number);
    queue.emplace(gap.order(), number);
  }
  // Who is looked at has only surer ones to heed, and those are settled.
  for (; !queue.empty(); queue.erase(queue.begin())) {
    const std::size_t number = queue.begin()->second;
    const bool best = is_best(number);
    if (slots_[number].chosen == best) continue;
    slots_[number].chosen = best;
    (best ? change.come : change.gone).push_back(number);
    ask_less_sure(number, queue);
  }
  for (const std::size_t number : change.gone) chosen_.erase(place_of(number));
  for (const std::size_t number : change.come) chosen_.insert(place_of(number), number);
  return change;
}

Numbers CutChoice::near(const Vec& p, const Vec& q, double margin_m) const {
  Numbers found = index_.near(p, q, margin_m);
  found.erase(std::remove_if(found.begin(), found.end(), [&](std::size_t k) { return !slots_[k].chosen; }), found.end());
  return found;
}

}  // namespace modslam
