// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/opening_model.hpp"

#include <cmath>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "common/formats/file_bytes.hpp"
#include "common/semantics/openings.hpp"

namespace modslam {
namespace {

using Node = OpeningModel::Node;

namespace sensed {
#include "common/semantics/opening_trees.inc"
}
namespace finished {
#include "common/semantics/finished_opening_trees.inc"
}

}  // namespace

OpeningModel::OpeningModel(Kind kind) {
  const auto take = [&](double bias, const auto& roots, const auto& nodes) {
    bias_ = bias;
    roots_.assign(std::begin(roots), std::end(roots));
    nodes_.assign(std::begin(nodes), std::end(nodes));
  };
  if (kind == Kind::kSensed) take(sensed::kBias, sensed::kRoots, sensed::kNodes);
  else take(finished::kBias, finished::kRoots, finished::kNodes);
}

OpeningModel::OpeningModel(const std::string& path, Kind kind) : OpeningModel(kind) {
  if (path.empty()) return;
  std::istringstream in(read_file_bytes(path).bytes);
  bias_ = 0;
  roots_.clear();
  nodes_.clear();
  read(in, path);
  check(path);
}

void OpeningModel::read(std::istream& in, const std::string& path) {
  std::string line, word;
  for (int number = 1; std::getline(in, line); ++number) {
    std::istringstream words(line);
    if (!(words >> word)) continue;
    Node node{};
    int root = 0;
    if (word == "bias" && words >> bias_) continue;
    if (word == "root" && words >> root)
      roots_.push_back(root);
    else if (word == "node" && words >> node.feature >> node.bound >> node.left >> node.right >> node.value)
      nodes_.push_back(node);
    else
      throw std::runtime_error(path + ", line " + std::to_string(number) + ": no bias, root or node: " + line);
  }
}

/// Children come after their parents, so every way down ends.
void OpeningModel::check(const std::string& path) const {
  const int count = static_cast<int>(nodes_.size());
  for (const int root : roots_)
    if (root < 0 || root >= count) throw std::runtime_error(path + ": no node " + std::to_string(root));
  for (int k = 0; k < count; ++k) {
    const Node& node = nodes_[static_cast<std::size_t>(k)];
    const bool leaf = node.feature < 0;
    if (!leaf && (node.feature >= kOpeningFeatures || node.left <= k || node.right <= k || node.left >= count || node.right >= count))
      throw std::runtime_error(path + ": node " + std::to_string(k) + " leads nowhere");
  }
}

double OpeningModel::probability(const float* features) const {
  double score = bias_;
  for (const int root : roots_) {
    const Node* node = &nodes_[static_cast<std::size_t>(root)];
    while (node->feature >= 0) node = &nodes_[static_cast<std::size_t>(features[node->feature] <= node->bound ? node->left : node->right)];
    score += node->value;
  }
  return 1 / (1 + std::exp(-score));
}

}  // namespace modslam
