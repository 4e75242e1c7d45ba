// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/estimator_journal.hpp"

#include <algorithm>
#include <map>
#include <modslam/estimator_anchor_t.hpp>
#include <modslam/graph_update_t.hpp>
#include <modslam/loop_closure_t.hpp>
#include <set>

#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/estimator_session.hpp"
#include "common/bus/graph_mirror.hpp"

namespace modslam {
namespace {

/// The journal's content up to its last state.
struct Records {
  estimator_state_t state{};
  std::optional<estimator_anchor_t> anchor;
  std::map<NodeId, graph_node_t> nodes;
  std::map<std::int64_t, std::map<int, graph_update_t>> updates;  ///< by seq, then chunk
  std::vector<LoopProposal> loops;
};

/// Takes in what one state completes. @throws BadMessage
void take(const std::vector<LogEvent>& completed, Records& records) {
  for (const LogEvent& record : completed) {
    graph_node_t node{};
    graph_update_t update{};
    loop_closure_t loop{};
    estimator_anchor_t anchor{};
    if (record.channel == channel::kNode && read_record(record, node)) {
      records.nodes[node.id] = std::move(node);
    } else if (record.channel == channel::kGraph && read_record(record, update)) {
      if (update.chunk == 0) records.updates[update.seq].clear();
      records.updates[update.seq][update.chunk] = std::move(update);
    } else if (record.channel == kLoopRecord && read_record(record, loop)) {
      records.loops.push_back(to_loop(loop));
    } else if (record.channel == kEstimatorAnchor && read_record(record, anchor)) {
      records.anchor = anchor;
    }
  }
}

bool read_records(Journal& journal, Records& records) {
  std::vector<LogEvent> open;
  bool any = false;
  journal.read_past([&](const LogEvent& event) {
    estimator_state_t state{};
    if (event.channel != kEstimatorState) {
      open.push_back(event);
    } else if (read_record(event, state)) {
      take(open, records);
      open.clear();
      records.state = state;
      any = true;
    }
  });
  return any;
}

/// Edges and poses after all updates; loop edges that ever were go into `accepted`.
void apply_updates(const Records& records, EstimatorMemory& memory, std::vector<GraphEdge>& accepted) {
  std::map<EdgeId, GraphEdge> edges;
  for (const auto& [seq, chunks] : records.updates) {
    if (seq > records.state.graph_seq) break;
    for (const auto& [chunk, update] : chunks) {
      for (const graph_edge_t& message : update.edges) {
        const GraphEdge edge = to_edge(message);
        if (std::max(edge.from, edge.to) >= records.state.nnodes) throw BadMessage("an edge to a node that is not in it");
        memory.next_edge = std::max(memory.next_edge, edge.id + 1);
        if (edge.kind == EdgeKind::kLoop) accepted.push_back(edge);
        edges[edge.id] = edge;
      }
      for (const EdgeId id : update.retracted) memory.retracted += static_cast<std::int64_t>(edges.erase(id));
      for (const node_pose_t& pose : update.poses)
        if (pose.id >= 0 && pose.id < static_cast<NodeId>(memory.graph.poses.size()))
          memory.graph.poses[static_cast<std::size_t>(pose.id)] = to_pose(pose.T_map_base);
    }
  }
  memory.accepted = static_cast<std::int64_t>(accepted.size());
  for (const auto& [id, edge] : edges) memory.graph.edges.push_back(edge);
}

void place_robot(const Records& records, EstimatorMemory& memory) {
  const Pose2 T_node_base = to_pose(records.state.T_node_base);
  memory.robot = {records.anchor ? records.anchor->node : records.state.nnodes - 1, T_node_base, to_matrix(records.state.covariance)};
  memory.T_step_base = records.anchor ? to_pose(records.anchor->T_step_base) : T_node_base;
  if (memory.robot.node < 0 || memory.robot.node >= records.state.nnodes) throw BadMessage("its robot hangs on a node that is not in it");
}

bool was_accepted(const LoopProposal& loop, const std::vector<GraphEdge>& accepted) {
  return std::any_of(accepted.begin(), accepted.end(), [&](const GraphEdge& edge) { return edge.from == loop.from && edge.to == loop.to; });
}

std::string missing(const Records& records) {
  for (NodeId id = 0; id < records.state.nnodes; ++id)
    if (!records.nodes.count(id)) return "node " + std::to_string(id) + " is not in it";
  for (std::int64_t seq = 1; seq <= records.state.graph_seq; ++seq) {
    const auto update = records.updates.find(seq);
    if (update == records.updates.end() || update->second.empty() ||
        static_cast<int>(update->second.size()) != update->second.begin()->second.nchunks)
      return "graph update " + std::to_string(seq) + " is not whole in it";
  }
  return "";
}

}  // namespace

std::optional<EstimatorPast> read_estimator_journal(Journal& journal, std::string& trouble) {
  Records records;
  EstimatorPast past;
  try {
    if (!read_records(journal, records)) return std::nullopt;
    if (trouble = missing(records); !trouble.empty()) return std::nullopt;
    for (NodeId id = 0; id < records.state.nnodes; ++id) {
      past.nodes.push_back(std::move(records.nodes[id]));
      past.memory.graph.poses.push_back(to_pose(past.nodes.back().T_map_base));
    }
    std::vector<GraphEdge> accepted;
    apply_updates(records, past.memory, accepted);
    for (const LoopProposal& loop : records.loops)
      if (is_usable(loop.verdict) && !was_accepted(loop, accepted)) past.memory.waiting.push_back(loop);
    place_robot(records, past.memory);
    if (records.anchor) past.unrecognised = records.anchor->unrecognised;
  } catch (const BadMessage& bad) {
    trouble = bad.what();
    return std::nullopt;
  }
  past.memory.postponed = records.state.postponed;
  past.memory.epoch = records.state.epoch;
  past.state = records.state;
  past.loops = std::move(records.loops);
  return past;
}

}  // namespace modslam
