// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/loop_book.hpp"

#include <catch2/catch.hpp>
#include <modslam/scan_match_t.hpp>

#include "common/bus/bus.hpp"
#include "viewer/events.hpp"

namespace modslam {
namespace {

GraphEdge edge(EdgeId id, NodeId from, NodeId to, EdgeKind kind) {
  GraphEdge e;
  e.id = id;
  e.from = from;
  e.to = to;
  e.kind = kind;
  return e;
}

loop_closure_t proposal(NodeId from, NodeId to, int verdict) {
  loop_closure_t m{};
  m.from_node = from;
  m.to_node = to;
  m.verdict = static_cast<std::int8_t>(verdict);
  return m;
}

TEST_CASE("a loop edge that leaves the graph was taken back, edges along the path are no loops") {
  LoopBook book;
  std::vector<GraphEdge> edges = {edge(0, 0, 1, EdgeKind::kSequence), edge(1, 0, 9, EdgeKind::kLoop), edge(2, 1, 8, EdgeKind::kLoop)};
  CHECK(book.see_edges(edges).closed == std::vector<LoopBook::Pair>{{0, 9}, {1, 8}});
  edges.erase(edges.begin() + 1);
  const LoopBook::Change change = book.see_edges(edges);
  CHECK(change.closed.empty());
  CHECK(change.retracted == std::vector<LoopBook::Pair>{{0, 9}});
  const auto json = book.edges_json(3);
  CHECK(json["loops"] == nlohmann::json::parse("[[1,8,2]]"));
  CHECK(json["retracted"] == nlohmann::json::parse("[[0,9]]"));
}

TEST_CASE("proposals are told with their verdict, the newest thousand of them") {
  LoopBook book;
  for (int i = 0; i < 1500; ++i)
    book.propose(proposal(i, i + 100, i % 3 ? scan_match_t::OK : scan_match_t::AMBIGUOUS));
  CHECK(book.proposed() == 1000);
  CHECK(book.refused() == 500);
  const nlohmann::json columns = book.proposals_json();
  for (const char* name : {"from", "to", "verdict", "refused", "score", "overlap", "innovation"}) CHECK(columns[name].size() == LoopBook::kKept);
  CHECK(columns["from"].back() == 1499);
  CHECK(columns["verdict"].back() == "ok");
  CHECK(columns["refused"][1] == true);
  auto bad = proposal(1, 2, scan_match_t::OK);
  bad.score = std::numeric_limits<double>::infinity();
  CHECK_THROWS_AS(book.propose(bad), BadMessage);
}

TEST_CASE("events tell of a failed match once, of new rooms once, of a process that came again") {
  Events events;
  pose_estimate_t pose{};
  for (const int verdict :
       {scan_match_t::OK, scan_match_t::FAILED, scan_match_t::FAILED, scan_match_t::OK}) {
    pose.verdict = static_cast<std::int8_t>(verdict);
    events.see_pose(pose);
  }
  const nlohmann::json room = {{{"id", 4}, {"name", ""}, {"type", "room"}, {"area_m2", 12.5}}};
  events.see_list(5, "rooms", room);
  events.see_list(6, "rooms", room);
  process_status_t status{};
  status.name = "laser";
  status.state = process_status_t::RUNNING;
  for (const int pid : {10, 10, 11}) {
    status.pid = pid;
    events.see_status(7, status);
  }
  std::vector<std::string> words;
  const nlohmann::json told = events.to_json();
  for (const auto& item : told["items"]) words.push_back(item[2]);
  CHECK(words == std::vector<std::string>{"match failed: failed", "matches again",
                                          "room 4 found, 12.5 m²", "laser was started again"});
  for (int i = 0; i < 1000; ++i) events.say(i, "loop", "closed");
  CHECK(events.to_json()["items"].size() == Events::kKept);
}

}  // namespace
}  // namespace modslam
