// SPDX-License-Identifier: BSD-3-Clause
#include <civetweb.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <condition_variable>
#include <modslam/command_t.hpp>
#include <modslam/graph_node_t.hpp>
#include <modslam/pose_estimate_t.hpp>
#include <modslam/process_status_t.hpp>
#include <modslam/room_list_t.hpp>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/bus/bus.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/modules.hpp"
#include "common/bus/system_config.hpp"

namespace modslam {
namespace {

using nlohmann::json;

/// A page without a browser: keeps the JSON that it is sent.
class Page {
 public:
  Page(int port, const char* origin) {
    connection_ = mg_connect_websocket_client("127.0.0.1", port, 0, error_, sizeof error_, "/ws",
                                              origin, hear, nullptr, this);
  }
  ~Page() {
    if (connection_) mg_close_connection(connection_);
  }
  bool connected() const { return connection_ != nullptr; }
  void say(const std::string& words) {
    mg_websocket_client_write(connection_, MG_WEBSOCKET_OPCODE_TEXT, words.data(), words.size());
  }
  /// The first frame that is `wanted`; null after two seconds.
  template <class Wanted>
  json wait(Wanted wanted) {
    std::unique_lock lock(mutex_);
    json found;
    came_.wait_for(lock, std::chrono::seconds(2), [&] {
      for (const json& frame : frames_)
        if (wanted(frame)) found = frame;
      return !found.is_null();
    });
    return found;
  }
  json wait_for(const std::string& stream) {
    return wait([&](const json& frame) { return frame["stream"] == stream; });
  }

 private:
  static int hear(mg_connection*, int bits, char* bytes, std::size_t size, void* self) {
    auto* page = static_cast<Page*>(self);
    if ((bits & 0x0f) != MG_WEBSOCKET_OPCODE_TEXT) return 1;
    const std::lock_guard lock(page->mutex_);
    page->frames_.push_back(json::parse(bytes, bytes + size));
    page->came_.notify_all();
    return 1;
  }

  char error_[200] = {};
  mg_connection* connection_ = nullptr;
  std::mutex mutex_;
  std::condition_variable came_;
  std::vector<json> frames_;
};

struct Fixture {
  Transport transport{"memq://"};
  Bus bus{transport, "viewer"}, world{transport, "world"};
  std::unique_ptr<Module> viewer;
  std::int64_t steady_us = 1'000'000;

  Fixture() {
    SystemConfig config;
    config.viewer.port = 0;
    viewer = make_viewer(bus, config);
  }
  int port() const {
    const std::string words = viewer->words(), before = "http://127.0.0.1:";
    REQUIRE(words.rfind(before, 0) == 0);
    return std::stoi(words.substr(before.size()));
  }
  void settle() {
    while (transport.poll(0)) {
    }
    viewer->tick(steady_us += 1'000'000);
  }
  void publish_node(std::int64_t id, std::int64_t utime, double x_m) {
    graph_node_t node{};
    node.id = id;
    node.utime = utime;
    put(node.T_map_base, Pose2(x_m, 0, 0));
    node.sensor = to_message(SensorInfo{}, utime);
    Scan scan;
    scan.ranges_m = {1, 2, 3};
    scan.radstep = 0.1;
    node.scan = to_message(scan);
    world.publish(channel::kNode, node);
  }
};

TEST_CASE("a page that opens late is told the whole state") {
  Fixture f;
  process_status_t status{};
  status.name = "laser";
  status.state = process_status_t::TROUBLED;
  f.world.publish(channel::kStatus, status);
  for (int i = 0; i < 300; ++i) f.publish_node(i, 1000 + i, 0.1 * i);
  f.settle();

  Page page(f.port(), nullptr);
  REQUIRE(page.connected());
  CHECK(!page.wait_for("hello").is_null());
  CHECK(page.wait_for("status")["state"] == "troubled");
  const json last = page.wait(
      [](const json& frame) { return frame["stream"] == "nodes" && frame["first"] == 256; });
  REQUIRE(last["poses"].size() == 3 * (300 - 256));
  CHECK(last["poses"][0] == 25.6);
}

TEST_CASE("the graph of another session makes the page forget the old one") {
  Fixture f;
  f.publish_node(0, 1000, 1.0);
  f.publish_node(1, 2000, 2.0);
  f.settle();
  Page page(f.port(), nullptr);
  REQUIRE(!page.wait_for("nodes").is_null());
  f.publish_node(0, 9'000'000, 7.0);
  f.settle();
  const json fresh = page.wait(
      [](const json& frame) { return frame["stream"] == "nodes" && frame["poses"][0] == 7.0; });
  REQUIRE(!fresh.is_null());
  CHECK(fresh["poses"].size() == 3);
}

TEST_CASE("a damaged list is counted as bad and not shown") {
  Fixture f;
  room_list_t list{};
  list.version = list.nchunks = list.nrooms = 1;
  list.rooms.resize(1);  // a room without corners
  f.world.publish(channel::kRooms, list);
  f.settle();
  CHECK(f.bus.inputs().at(channel::kRooms).bad == 1);
  Page page(f.port(), nullptr);
  const json clock = page.wait_for("clock");
  const bool told =
      std::any_of(clock["channels"].begin(), clock["channels"].end(),
                  [](const json& c) { return c["channel"] == channel::kRooms && c["bad"] == 1; });
  CHECK(told);
}

TEST_CASE("a page of another origin is refused, the viewer's own is not") {
  Fixture f;
  CHECK_FALSE(Page(f.port(), "http://evil.example").connected());
  CHECK_FALSE(Page(f.port(), "null").connected());
  CHECK(Page(f.port(), "http://127.0.0.1")
            .connected());  // this client names its host without the port
}

TEST_CASE("what a page wishes of the player reaches the bus, anything else ends its connection") {
  Fixture f;
  std::vector<std::string> verbs;
  f.world.subscribe<command_t>(channel::kPlaybackCommand, [&](const command_t& m) {
    CHECK(m.target == "player");
    verbs.push_back(m.verb);
  });
  Page page(f.port(), nullptr);
  REQUIRE(!page.wait_for("hello").is_null());
  page.say("pause");
  page.say("speed 4");
  for (int i = 0; i < 100 && verbs.size() < 2; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    f.settle();
  }
  CHECK(verbs == std::vector<std::string>{"pause", "speed 4"});
  page.say("finish");
  const auto nobody_looks = [&] { return f.viewer->words().find("pages open: 0") != std::string::npos; };
  for (int i = 0; i < 200 && !nobody_looks(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  f.settle();
  CHECK(verbs.size() == 2);
  CHECK(nobody_looks());
}

/// Body of a GET, or "" when the status is not 200.
std::string get(int port, const std::string& path, const char* origin = nullptr) {
  char error[200] = {};
  mg_connection* connection =
      mg_download("127.0.0.1", port, 0, error, sizeof error,
                  "GET %s HTTP/1.0\r\nHost: 127.0.0.1:%d\r\n%s%s%s\r\n", path.c_str(), port,
                  origin ? "Origin: " : "", origin ? origin : "", origin ? "\r\n" : "");
  if (!connection) return "";
  const bool good = mg_get_response_info(connection)->status_code == 200;
  std::string body;
  char buffer[4096];
  for (int n; (n = mg_read(connection, buffer, sizeof buffer)) > 0;)
    body.append(buffer, static_cast<std::size_t>(n));
  mg_close_connection(connection);
  return good ? body : "";
}

TEST_CASE("the past holds the rooms of then, and is not for pages of others") {
  Fixture f;
  const auto publish = [&](std::int64_t utime, double area_m2) {
    pose_estimate_t pose{};
    pose.utime = utime;
    pose.node_id = pose.node_before = -1;
    f.world.publish(channel::kPose, pose);
    room_list_t list{};
    list.version = utime;
    list.nchunks = list.nrooms = 1;
    list.rooms.resize(1);
    list.rooms[0].area_m2 = area_m2;
    list.rooms[0].npoints = 3;
    list.rooms[0].x = {0, 1, 1};
    list.rooms[0].y = {0, 0, 1};
    f.world.publish(channel::kRooms, list);
    f.settle();
  };
  publish(1'000'000, 11);
  publish(50'000'000, 22);
  CHECK_THAT(get(f.port(), "/past?utime=20000000"), Catch::Contains("\"area_m2\":11.0"));
  CHECK_THAT(get(f.port(), "/past?utime=60000000"), Catch::Contains("\"area_m2\":22.0"));
  CHECK(get(f.port(), "/past?utime=60000000", "http://evil.example").empty());
  CHECK(get(f.port(), "/past?utime=x").empty());
  CHECK(get(f.port(), "/past").empty());
}

TEST_CASE("two viewers on one port: the second says which port is taken") {
  Fixture f;
  SystemConfig config;
  config.viewer.port = f.port();
  Transport transport("memq://");
  Bus other(transport, "viewer");
  CHECK_THROWS_WITH(make_viewer(other, config), Catch::Contains(std::to_string(f.port())));
}

}  // namespace
}  // namespace modslam
