// SPDX-License-Identifier: BSD-3-Clause
/// @file What became of every loop: accepted, taken back, refused, or still only proposed.
#pragma once
#include <deque>
#include <map>
#include <modslam/loop_closure_t.hpp>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "common/graph/types.hpp"

namespace modslam {

class LoopBook {
 public:
  static constexpr std::size_t kKept = 1000;  ///< proposals and loops taken back, newest

  /// @throws BadMessage on impossible numbers.
  void propose(const loop_closure_t& message);

  using Pair = std::pair<NodeId, NodeId>;
  struct Change {
    std::vector<Pair> closed, retracted;
  };
  /// Compares with the edges of the graph as they are now. @return what has changed.
  Change see_edges(const std::vector<GraphEdge>& edges);
  void clear();

  std::int64_t proposed() const { return proposed_; }  ///< with a good verdict
  std::int64_t refused() const { return refused_; }

  nlohmann::json edges_json(std::int64_t epoch) const;
  /// A column for each figure, oldest proposal first: rows of named values would need ten times the memory.
  nlohmann::json proposals_json() const;

 private:
  struct Proposal {
    NodeId from, to;
    float score, overlap, innovation;
    std::int8_t verdict;
    bool refused;
  };
  std::map<EdgeId, Pair> accepted_;
  std::deque<Pair> retracted_;
  std::deque<Proposal> proposals_;
  std::int64_t proposed_ = 0, refused_ = 0;
};

}  // namespace modslam
