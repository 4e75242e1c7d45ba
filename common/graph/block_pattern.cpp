// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/block_pattern.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>

namespace modslam {
namespace {

/// Neighbours of each variable, without repeats.
struct Neighbours {
  std::vector<int> start, of;

  Neighbours(int variables, const std::vector<BlockPattern::Link>& links) : start(static_cast<std::size_t>(variables) + 1, 0) {
    for (const auto& [a, b] : links)
      if (a >= 0 && b >= 0) ++start[static_cast<std::size_t>(a) + 1], ++start[static_cast<std::size_t>(b) + 1];
    for (std::size_t v = 1; v < start.size(); ++v) start[v] += start[v - 1];
    of.resize(static_cast<std::size_t>(start.back()));
    std::vector<int> next(start.begin(), start.end() - 1);
    for (const auto& [a, b] : links) {
      if (a < 0 || b < 0) continue;
      of[static_cast<std::size_t>(next[static_cast<std::size_t>(a)]++)] = b;
      of[static_cast<std::size_t>(next[static_cast<std::size_t>(b)]++)] = a;
    }
    drop_repeats();
  }

 private:
  void drop_repeats() {
    auto kept = of.begin();
    for (std::size_t v = 0; v + 1 < start.size(); ++v) {
      const auto first = of.begin() + start[v], last = of.begin() + start[v + 1];
      std::sort(first, last);
      start[v] = static_cast<int>(kept - of.begin());
      kept = std::copy(first, std::unique(first, last), kept);
    }
    start.back() = static_cast<int>(kept - of.begin());
    of.erase(kept, of.end());
  }
};

/// @return the place of each variable in an order with little fill.
std::vector<int> order_for_little_fill(const Neighbours& near) {
  const auto n = static_cast<Eigen::Index>(near.start.size()) - 1;
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.resizeNonZeros(static_cast<Eigen::Index>(near.of.size()) + n);
  int entry = 0;
  for (Eigen::Index v = 0; v < n; ++v) {
    const auto first = near.of.begin() + near.start[static_cast<std::size_t>(v)],
               last = near.of.begin() + near.start[static_cast<std::size_t>(v) + 1];
    const auto put = [&](int row) {
      matrix.innerIndexPtr()[entry] = row;
      matrix.valuePtr()[entry++] = 1.0;
    };
    const auto below = std::lower_bound(first, last, static_cast<int>(v));
    std::for_each(first, below, put);
    put(static_cast<int>(v));  // Eigen's ordering takes a variable without a diagonal for one that is linked with all
    std::for_each(below, last, put);
    matrix.outerIndexPtr()[v + 1] = entry;
  }
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(matrix, order);
  std::vector<int> place(static_cast<std::size_t>(n));
  for (Eigen::Index p = 0; p < n; ++p) place[static_cast<std::size_t>(order.indices()[p])] = static_cast<int>(p);
  return place;
}

}  // namespace

BlockPattern::BlockPattern(int variables, const std::vector<Link>& links) {
  const Neighbours near(variables, links);
  const auto n = static_cast<std::size_t>(variables);
  place_ = n ? order_for_little_fill(near) : std::vector<int>();
  std::vector<int> variable_at(n);
  for (std::size_t v = 0; v < n; ++v) variable_at[static_cast<std::size_t>(place_[v])] = static_cast<int>(v);

  // Row r of L: from each neighbour at an earlier place up the elimination tree, as far as this row has not been (Davis,
  // Direct Methods for Sparse Linear Systems, 2006, section 4.1).
  std::vector<int> parent(n, -1), visited(n, -1), row_of_entry, column_of_entry;
  column_start_.assign(n + 1, 0);
  for (std::size_t r = 0; r < n; ++r) {
    visited[r] = static_cast<int>(r);
    const auto v = static_cast<std::size_t>(variable_at[r]);
    for (int k = near.start[v]; k < near.start[v + 1]; ++k) {
      auto c = static_cast<std::size_t>(place_[static_cast<std::size_t>(near.of[static_cast<std::size_t>(k)])]);
      while (c < r && visited[c] != static_cast<int>(r)) {
        visited[c] = static_cast<int>(r);
        row_of_entry.push_back(static_cast<int>(r));
        column_of_entry.push_back(static_cast<int>(c));
        ++column_start_[c + 1];
        if (parent[c] < 0) parent[c] = static_cast<int>(r);
        c = static_cast<std::size_t>(parent[c]);
      }
    }
  }
  for (std::size_t c = 0; c < n; ++c) column_start_[c + 1] += column_start_[c];
  rows_.resize(row_of_entry.size());
  std::vector<int> next(column_start_.begin(), column_start_.end() - 1);
  for (std::size_t k = 0; k < row_of_entry.size(); ++k)  // rows come in ascending order, so columns do too
    rows_[static_cast<std::size_t>(next[static_cast<std::size_t>(column_of_entry[k])]++)] = row_of_entry[k];
}

int BlockPattern::entry(int row, int column) const {
  const auto first = rows_.begin() + begin(column), last = rows_.begin() + begin(column + 1);
  return static_cast<int>(std::lower_bound(first, last, row) - rows_.begin());
}

}  // namespace modslam
