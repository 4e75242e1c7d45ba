// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/region_clusters.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <queue>
#include <tuple>

namespace modslam {
namespace {

struct Candidate {
  double weight;
  int p, q;   ///< p < q
  bool operator<(const Candidate& o) const { return std::tuple(weight, -p, -q) < std::tuple(o.weight, -o.p, -o.q); }
};

}  // namespace

std::vector<int> cluster_pieces(int count, const std::vector<PieceBond>& bonds) {
  std::vector<std::map<int, double>> bonds_of(static_cast<std::size_t>(count));
  const auto of = [&](int piece) -> std::map<int, double>& { return bonds_of[static_cast<std::size_t>(piece)]; };
  for (const PieceBond& bond : bonds)
    if (bond.p != bond.q) of(bond.p)[bond.q] = of(bond.q)[bond.p] += bond.weight;
  std::priority_queue<Candidate> queue;
  for (int p = 0; p < count; ++p)
    for (const auto& [q, weight] : of(p))
      if (p < q && weight > 0) queue.push({weight, p, q});

  std::vector<int> parent(static_cast<std::size_t>(count));
  std::iota(parent.begin(), parent.end(), 0);
  while (!queue.empty()) {
    const Candidate best = queue.top();
    queue.pop();
    const auto still = of(best.p).find(best.q);
    if (still == of(best.p).end() || still->second != best.weight) continue;  // joined with something since
    const int keeps = of(best.p).size() >= of(best.q).size() ? best.p : best.q, goes = keeps == best.p ? best.q : best.p;
    parent[static_cast<std::size_t>(goes)] = keeps;
    of(keeps).erase(goes);
    for (const auto& [other, weight] : of(goes)) {
      if (other == keeps) continue;
      of(other).erase(goes);
      const double sum = of(keeps)[other] = of(other)[keeps] += weight;
      if (sum > 0) queue.push({sum, std::min(keeps, other), std::max(keeps, other)});
    }
    of(goes).clear();
  }
  for (int k = 0; k < count; ++k) {
    int root = k;
    while (parent[static_cast<std::size_t>(root)] != root) root = parent[static_cast<std::size_t>(root)];
    parent[static_cast<std::size_t>(k)] = root;
  }
  return parent;
}

}  // namespace modslam
