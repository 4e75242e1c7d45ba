// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/region_clusters.hpp"

#include <algorithm>
#include <map>
#include <queue>
#include <tuple>
#include <unordered_map>

#include "common/graph/disjoint_sets.hpp"

namespace modslam {
namespace {

struct Candidate {
  double weight;
  int p, q;   ///< p < q
  bool operator<(const Candidate& o) const { return std::tuple(weight, -p, -q) < std::tuple(o.weight, -o.p, -o.q); }
};

}  // namespace

std::vector<int> cluster_pieces(int count, const std::vector<PieceBond>& bonds) {
  const auto place = [](int piece) { return static_cast<std::size_t>(piece); };
  DisjointSets clusters(place(count)), reach(place(count));
  for (const PieceBond& bond : bonds)
    if (bond.weight > 0) reach.join(place(bond.p), place(bond.q));
  // Between what no chain of positive bonds joins no sum of bonds is ever positive.
  std::unordered_map<int, std::map<int, double>> bonds_of;
  for (const PieceBond& bond : bonds)
    if (bond.p != bond.q && reach.root(place(bond.p)) == reach.root(place(bond.q))) bonds_of[bond.p][bond.q] = bonds_of[bond.q][bond.p] += bond.weight;
  std::priority_queue<Candidate> queue;
  for (const auto& [p, those] : bonds_of)
    for (const auto& [q, weight] : those)
      if (p < q && weight > 0) queue.push({weight, p, q});

  while (!queue.empty()) {
    const Candidate best = queue.top();
    queue.pop();
    std::map<int, double>&of_p = bonds_of[best.p], &of_q = bonds_of[best.q];
    const auto still = of_p.find(best.q);
    if (still == of_p.end() || still->second != best.weight) continue;  // joined with something since
    const int keeps = of_p.size() >= of_q.size() ? best.p : best.q, goes = keeps == best.p ? best.q : best.p;
    clusters.join(place(goes), place(keeps));
    bonds_of[keeps].erase(goes);
    for (const auto& [other, weight] : bonds_of[goes]) {
      if (other == keeps) continue;
      bonds_of[other].erase(goes);
      const double sum = bonds_of[keeps][other] = bonds_of[other][keeps] += weight;
      if (sum > 0) queue.push({sum, std::min(keeps, other), std::max(keeps, other)});
    }
    bonds_of[goes].clear();
  }
  std::vector<int> out(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) out[place(k)] = static_cast<int>(clusters.root(place(k)));
  return out;
}

}  // namespace modslam
