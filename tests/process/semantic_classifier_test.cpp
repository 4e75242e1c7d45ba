// SPDX-License-Identifier: BSD-3-Clause
#include <catch2/catch.hpp>
#include <modslam/graph_node_t.hpp>
#include <modslam/sync_request_t.hpp>

#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/modules.hpp"
#include "common/bus/semantic_messages.hpp"
#include "common/bus/system_config.hpp"
#include "tests/support/ray_world.hpp"

using namespace modslam;

namespace {

void drain(Transport& transport) {
  while (transport.poll(0)) continue;
}

void publish_nodes(Bus& bus, test::RayWorld& world, int n) {
  for (int i = 0; i < n; ++i) {
    const Pose2 pose(0.2 * i - 1, 0.1 * i - 0.5, 0.4 * i);
    graph_node_t node{};
    node.utime = 1000000 + 500000 * i;
    node.id = i;
    put(node.T_map_base, pose);
    node.sensor = to_message(test::RayWorld::sensor(), node.utime);
    Scan scan = world.scan(pose);
    scan.utime = node.utime;
    node.scan = to_message(scan);
    bus.publish(channel::kNode, node);
  }
}

}  // namespace

TEST_CASE("Nodes in, walls and a room out, and again for whoever asks", "[process][semantics]") {
  Transport transport("memq://");
  Bus source(transport, "source"), consumer_bus(transport, "consumer"),
      bus(transport, "semantic_classifier");
  SemanticMirror mirror(consumer_bus);
  const auto module = make_semantic_classifier(bus, SystemConfig());
  module->finish();
  drain(transport);
  CHECK(bus.outputs().count(channel::kWalls) == 0);  // nothing computed, nothing said

  test::RayWorld world;
  world.box(-4, -3, 4, 3);
  publish_nodes(source, world, 12);
  drain(transport);
  CHECK_FALSE(mirror.semantics().walls.empty());
  module->finish();
  drain(transport);
  CHECK(mirror.semantics().walls.size() == 4);
  REQUIRE(mirror.semantics().rooms.size() == 1);
  CHECK(mirror.semantics().rooms.front().area_m2 == Approx(48).margin(1));

  Bus late_bus(transport, "late");
  SemanticMirror late(late_bus);
  sync_request_t request{};
  request.requester = "late";
  late_bus.publish(channel::kSyncRequest, request);
  drain(transport);
  CHECK(late.semantics().walls.size() == 4);
}

TEST_CASE("Long lists travel in chunks below 60 kB and come together again in any order",
          "[semantics]") {
  std::vector<Wall> walls;
  for (int i = 0; i < 3000; ++i) walls.push_back({i + 1, {{i * 1.0, 0}, {i + 0.5, 1}}, 2.5, 0.01});
  auto chunks = to_messages(walls, 5, 7);
  REQUIRE(chunks.size() > 2);
  std::swap(chunks.front(), chunks.back());
  ListAssembler<wall_list_t, Wall> assembler;
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    CHECK(chunks[i].getEncodedSize() < 60000);
    CHECK(assembler.add(chunks[i]) == (i + 1 == chunks.size()));
  }
  REQUIRE(assembler.things().size() == walls.size());
  for (std::size_t i = 0; i < walls.size(); ++i) {
    CHECK(assembler.things()[i].id == walls[i].id);
    CHECK(assembler.things()[i].segment.b == walls[i].segment.b);
  }
  CHECK(assembler.version() == 7);
}

TEST_CASE("A chunk of a wild number or with a wild value is refused", "[semantics]") {
  ListAssembler<wall_list_t, Wall> assembler;
  wall_list_t message =
      to_messages(std::vector<Wall>{{1, {{0, 0}, {1, 0}}, 1, 0.01}}, 1, 1).front();
  message.nchunks = 0;
  CHECK_THROWS_AS(assembler.add(message), BadMessage);
  message.nchunks = 1;
  message.walls.front().a[0] = std::nan("");
  CHECK_THROWS_AS(assembler.add(message), BadMessage);
}
