// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/loop_book.hpp"

#include <cmath>

#include "common/bus/bus.hpp"
#include "viewer/verdict.hpp"

namespace modslam {

using nlohmann::json;

void LoopBook::propose(const loop_closure_t& message) {
  const auto number = [](double value) {
    if (!std::isfinite(value)) throw BadMessage("loop with an impossible number");
    return std::round(value * 1000) / 1000;
  };
  const bool good = is_good(message.verdict) || message.verdict == scan_match_t::DEGENERATE;
  proposals_.push_back({{"from", message.from_node},
                        {"to", message.to_node},
                        {"verdict", verdict_word(message.verdict)},
                        {"refused", !good},
                        {"score", number(message.score)},
                        {"overlap", number(message.overlap)},
                        {"innovation", number(message.innovation)}});
  if (proposals_.size() > kKept) proposals_.pop_front();
  ++(good ? proposed_ : refused_);
}

LoopBook::Change LoopBook::see_edges(const std::vector<GraphEdge>& edges) {
  Change change;
  std::set<EdgeId> in_force;
  for (const GraphEdge& edge : edges)
    if (edge.kind == EdgeKind::kLoop) in_force.insert(edge.id);
  for (auto it = accepted_.begin(); it != accepted_.end();) {
    if (in_force.count(it->first)) {
      ++it;
      continue;
    }
    change.retracted.push_back(it->second);
    retracted_.push_back(it->second);
    if (retracted_.size() > kKept) retracted_.pop_front();
    it = accepted_.erase(it);
  }
  for (const GraphEdge& edge : edges)
    if (edge.kind == EdgeKind::kLoop && accepted_.insert({edge.id, {edge.from, edge.to}}).second)
      change.closed.push_back({edge.from, edge.to});
  return change;
}

void LoopBook::clear() { *this = LoopBook(); }

json LoopBook::edges_json(std::int64_t epoch) const {
  json loops = json::array(), retracted = json::array();
  for (const auto& [id, pair] : accepted_) loops.push_back({pair.first, pair.second, id});
  for (const auto& [from, to] : retracted_) retracted.push_back({from, to});
  return {{"stream", "edges"},
          {"loops", std::move(loops)},
          {"retracted", std::move(retracted)},
          {"epoch", epoch}};
}

json LoopBook::proposals_json() const {
  json items = json::array();
  for (const json& proposal : proposals_) items.push_back(proposal);
  return {{"stream", "proposals"}, {"items", std::move(items)}};
}

}  // namespace modslam
