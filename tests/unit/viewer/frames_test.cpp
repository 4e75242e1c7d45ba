// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/frames.hpp"

#include <zlib.h>

#include <catch2/catch.hpp>
#include <cstring>
#include <limits>

#include "common/bus/bus.hpp"
#include "viewer/chunked_list.hpp"
#include "viewer/truth.hpp"
#include "viewer/web_server.hpp"

namespace modslam {
namespace {

using nlohmann::json;

map_tile_t tile_of(const std::vector<std::uint8_t>& cells, std::int32_t ncells) {
  map_tile_t tile{};
  tile.tile_x = -2;
  tile.tile_y = 5;
  tile.version = 9;
  tile.ncells = ncells;
  tile.resolution_m = 0.05;
  tile.encoding = map_tile_t::ZLIB;
  uLongf size = compressBound(cells.size());
  tile.data.resize(size);
  compress(tile.data.data(), &size, cells.data(), cells.size());
  tile.data.resize(size);
  tile.nbytes = static_cast<std::int32_t>(size);
  return tile;
}

template <class T>
T read(const std::string& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

TEST_CASE("a tile unpacks to its cells, and its frame says where it lies") {
  const std::vector<std::uint8_t> cells{0, 1, 128, 255};
  const map_tile_t tile = tile_of(cells, 2);
  CHECK(unpack_tile(tile) == cells);
  const FramePtr frame = tile_frame(tile);
  CHECK(frame->binary);
  CHECK(read<std::int32_t>(frame->bytes, 0) == -2);
  CHECK(read<std::int32_t>(frame->bytes, 4) == 5);
  CHECK(read<std::int32_t>(frame->bytes, 8) == 2);
  CHECK(read<std::int32_t>(frame->bytes, 12) == 9);
  CHECK(read<double>(frame->bytes, 16) == 0.05);
  CHECK(frame->bytes.size() == 24 + tile.data.size());
}

TEST_CASE("a tile that would not unpack on the page is refused") {
  const map_tile_t good = tile_of(std::vector<std::uint8_t>(16, 7), 4);
  const auto refused = [&](auto&& damage) {
    map_tile_t tile = good;
    damage(tile);
    CHECK_THROWS_AS(tile_frame(tile), BadMessage);
  };
  refused([](map_tile_t& t) { t.ncells = 5; });
  refused([](map_tile_t& t) { t.ncells = 3; });
  refused([](map_tile_t& t) { t.ncells = 0; });
  refused([](map_tile_t& t) { t.ncells = -4; });
  refused([](map_tile_t& t) { t.ncells = 1'000'000; });
  refused([](map_tile_t& t) { t.encoding = 7; });
  refused([](map_tile_t& t) { t.resolution_m = std::numeric_limits<double>::quiet_NaN(); });
  refused([](map_tile_t& t) { t.tile_x = std::numeric_limits<std::int32_t>::min(); });
  refused([](map_tile_t& t) { t.data.resize(t.data.size() - 1); });
  refused([](map_tile_t& t) { t.data.push_back(0); });
  refused([](map_tile_t& t) { t.data.clear(); });
}

room_list_t room_list(const std::string& name) {
  room_t room{};
  room.id = 3;
  room.name = name;
  room.type = room_t::CORRIDOR;
  room.area_m2 = 12.34567;
  room.x = {0, 4, 4};
  room.y = {0, 0, 3};
  room.npoints = 3;
  room_list_t list{};
  list.rooms = {room};
  list.nrooms = 1;
  return list;
}

TEST_CASE("whatever a room is called, its JSON can be read and gives the name back") {
  for (const std::string& name :
       {std::string("Küche \"7\""), std::string("</script>\n\\u0000"), std::string("a\0b", 3)}) {
    const json read = json::parse(text_frame(rooms_json({room_list(name)}))->bytes);
    CHECK(read["items"][0]["name"] == name);
    CHECK(read["items"][0]["type"] == "corridor");
    CHECK(read["items"][0]["area_m2"] == 12.346);
    CHECK(read["items"][0]["outline"] == json({0, 0, 4, 0, 4, 3}));
  }
  const json read = json::parse(text_frame(rooms_json({room_list("broken \xff UTF-8")}))->bytes);
  CHECK(read["items"][0]["name"] == "broken \xef\xbf\xbd UTF-8");
}

TEST_CASE("numbers that are no numbers never reach the page") {
  room_list_t list = room_list("x");
  list.rooms[0].x[1] = std::numeric_limits<double>::infinity();
  CHECK_THROWS_AS(rooms_json({list}), BadMessage);
  list = room_list("x");
  list.rooms[0].x.resize(2);
  list.rooms[0].y.resize(2);
  CHECK_THROWS_AS(rooms_json({list}), BadMessage);
  wall_list_t walls{};
  walls.walls.resize(1);
  walls.walls[0].sigma_m = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(walls_json({walls}), BadMessage);
}

TEST_CASE("a scan is drawn where the robot stood, without its missing returns") {
  Scan scan;
  scan.ranges_m = {2.0F, 0.0F, 100.0F, 3.0F};
  scan.radstep = kPi / 2;
  SensorInfo sensor;
  sensor.T_base_laser = Pose2(0.5, 0, 0);
  const json points = scan_json(scan, sensor, Pose2(10, 20, kPi / 2))["points"];
  REQUIRE(points.size() == 4);  // beam 0 straight ahead: map y; beam 3 to the right: map x
  CHECK(points[0].get<double>() == Approx(10).margin(1e-3));
  CHECK(points[1].get<double>() == Approx(22.5));
  CHECK(points[2].get<double>() == Approx(13));
  CHECK(points[3].get<double>() == Approx(20.5));
}

wall_list_t chunk_of(std::int64_t version, std::int32_t chunk, std::int32_t nchunks) {
  wall_list_t list{};
  list.version = version;
  list.chunk = chunk;
  list.nchunks = nchunks;
  return list;
}

TEST_CASE("a list is whole when the last of its chunks is here, in whatever order they came") {
  ChunkedList<wall_list_t> list;
  CHECK(!list.add(chunk_of(1, 2, 3)));
  CHECK(!list.add(chunk_of(1, 0, 3)));
  CHECK(!list.add(chunk_of(1, 0, 3)));
  const auto whole = list.add(chunk_of(1, 1, 3));
  REQUIRE(whole);
  REQUIRE(whole->size() == 3);
  CHECK((*whole)[2].chunk == 2);
  CHECK(list.incomplete() == 0);
}

TEST_CASE(
    "a list whose chunk got lost is counted and replaced, also by one of a restarted sender") {
  ChunkedList<wall_list_t> list;
  CHECK(!list.add(chunk_of(7, 0, 2)));
  CHECK(!list.add(chunk_of(8, 1, 2)));
  CHECK(list.incomplete() == 1);
  CHECK(list.add(chunk_of(1, 0, 1)));
  CHECK(list.incomplete() == 2);
  CHECK(list.add(chunk_of(1, 0, 1)));  // sent again for who came late
  CHECK_THROWS_AS(list.add(chunk_of(9, 2, 2)), BadMessage);
  CHECK_THROWS_AS(list.add(chunk_of(9, -1, 2)), BadMessage);
  CHECK_THROWS_AS(list.add(chunk_of(9, 0, 0)), BadMessage);
}

TEST_CASE("the true path begins where the estimate does and keeps its own shape") {
  const Pose2 T_map_world = Pose2(40, -7, 0.7).inverse();
  Truth truth;
  for (int i = 0; i < 20; ++i)
    truth.add({i * 10'000, T_map_world.inverse() * Pose2(0.1 * i, 0, 0), 0});
  CHECK(truth.trail().empty());
  truth.add_estimate(900'000'000, Pose2(1, 1, 1));  // nothing true beside it
  CHECK(truth.trail().empty());
  truth.add_estimate(51'000, Pose2(0.5, 0, 0));
  truth.add_estimate(100'000, Pose2(5, 5, 5));  // the estimate erred: the truth stays
  REQUIRE(truth.trail().size() == 2);  // from the estimate on, a straight line
  CHECK(truth.trail().front()[0] == Approx(0.5));
  CHECK(truth.trail().back()[0] == Approx(1.9));
  CHECK(truth.trail().back()[1] == Approx(0).margin(1e-9));
}

TEST_CASE("only the viewer's own page on this machine may listen") {
  CHECK(is_own_page("127.0.0.1:8080", "http://127.0.0.1:8080"));
  CHECK(is_own_page("localhost:9000", "http://localhost:9000"));  // a forwarded port
  CHECK(is_own_page("[::1]:9000", "http://[::1]:9000"));
  CHECK(is_own_page("127.0.0.1", ""));  // no browser
  CHECK_FALSE(is_own_page("127.0.0.1:8080", "http://evil.example"));
  CHECK_FALSE(is_own_page("127.0.0.1:8080", "http://127.0.0.1:3000"));
  CHECK_FALSE(is_own_page("127.0.0.1:8080", "https://127.0.0.1:8080"));
  CHECK_FALSE(is_own_page("127.0.0.1:8080", "null"));
  CHECK_FALSE(is_own_page("evil.example:8080", "http://evil.example:8080"));  // a rebound name
  CHECK_FALSE(is_own_page("127.0.0.1.evil.example", ""));
  CHECK_FALSE(is_own_page("", ""));
}

}  // namespace
}  // namespace modslam
