// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/loop_book.hpp"

#include <cmath>

#include "common/bus/bus.hpp"
#include "viewer/verdict.hpp"

namespace modslam {

using nlohmann::json;

void LoopBook::propose(const loop_closure_t& message) {
  const auto number = [](double value) {
    const auto figure = static_cast<float>(value);
    if (!std::isfinite(figure)) throw BadMessage("loop with an impossible number");
    return figure;
  };
  const bool good = is_good(message.verdict) || message.verdict == scan_match_t::DEGENERATE;
  proposals_.push_back({message.from_node, message.to_node, number(message.score), number(message.overlap), number(message.innovation), message.verdict, !good});
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
  json columns = {{"stream", "proposals"}};
  const auto column = [&](const char* name, auto value) {
    json& values = columns[name] = json::array();
    for (const Proposal& proposal : proposals_) values.push_back(value(proposal));
  };
  const auto rounded = [](float value) { return std::round(1000.0 * value) / 1000.0; };
  column("from", [](const Proposal& p) { return p.from; });
  column("to", [](const Proposal& p) { return p.to; });
  column("verdict", [](const Proposal& p) { return verdict_word(p.verdict); });
  column("refused", [](const Proposal& p) { return p.refused; });
  column("score", [&](const Proposal& p) { return rounded(p.score); });
  column("overlap", [&](const Proposal& p) { return rounded(p.overlap); });
  column("innovation", [&](const Proposal& p) { return rounded(p.innovation); });
  return columns;
}

}  // namespace modslam
