// SPDX-License-Identifier: BSD-3-Clause
/// @file How sure an opening parts two rooms: gradient-boosted trees over its features.
#pragma once
#include <array>
#include <cstddef>
#include <iosfwd>
#include <string>
#include <vector>

namespace modslam {

class OpeningModel {
 public:
  /// A node of a tree: go to `left` when the feature is at most the bound, else to `right`; a leaf has feature -1 and adds `value`.
  struct Node {
    int feature;
    float bound;
    int left, right;
    float value;
  };

  /// Maps that a robot makes show what it happened to see; in finished ones, drawn or mapped to the end, all walls stand.
  enum class Kind { kSensed, kFinished };

  /// The shipped trees, opening_trees.inc and finished_opening_trees.inc; `./run.sh train semantics` makes them anew.
  explicit OpeningModel(Kind kind = Kind::kSensed);
  /// Trees from a file that training wrote: "bias B", then "root K" and "node FEATURE BOUND LEFT RIGHT VALUE" lines. "": the shipped ones.
  /// @throws std::runtime_error naming file and line.
  explicit OpeningModel(const std::string& path, Kind kind = Kind::kSensed);

  /// 0..1. @param features  kOpeningFeatures numbers.
  double probability(const float* features) const;

 private:
  void read(std::istream& in, const std::string& path);
  void check(const std::string& path) const;

  double bias_ = 0;
  std::vector<int> roots_;
  std::vector<Node> nodes_;
};

}  // namespace modslam
