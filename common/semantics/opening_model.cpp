// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/opening_model.hpp"

#include <cmath>

namespace modslam {
namespace {

/// A node of a tree: go to `left` when the feature is at most the bound, else to `right`; a leaf has feature -1 and adds `value`.
struct Node {
  int feature;
  float bound;
  int left, right;
  float value;
};

#include "common/semantics/opening_trees.inc"

}  // namespace

double opening_probability(const std::array<float, kOpeningFeatures>& features) {
  double score = kBias;
  for (const int root : kRoots) {
    int at = root;
    while (kNodes[at].feature >= 0)
      at = features[static_cast<std::size_t>(kNodes[at].feature)] <= kNodes[at].bound ? kNodes[at].left : kNodes[at].right;
    score += kNodes[at].value;
  }
  return 1 / (1 + std::exp(-score));
}

}  // namespace modslam
