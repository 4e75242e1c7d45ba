// SPDX-License-Identifier: BSD-3-Clause
#include "procs/text_spy/traffic.hpp"

#include <catch2/catch.hpp>
#include <modslam/room_list_t.hpp>

#include "common/bus/channels.hpp"
#include "procs/text_spy/decode.hpp"

namespace modslam {
namespace {

TEST_CASE("a channel's rate and bandwidth are of the last seconds, its gaps of all time") {
  Traffic traffic;
  const char bytes[100] = {};
  for (int i = 0; i < 100; ++i) {
    const std::int64_t number = i < 50 ? i : i + 3;  // three are missing
    traffic.add("POSE", bytes, sizeof bytes, 0.1 * i, number);
  }
  const ChannelTraffic& pose = traffic.channels().at("POSE");
  const auto [rate_hz, bytes_per_s] = Traffic::rate(pose, 9.9);
  CHECK(rate_hz == Approx(10).margin(0.4));
  CHECK(bytes_per_s == Approx(1000).margin(40));
  CHECK(pose.missing == 3);
  CHECK(Traffic::rate(pose, 60).first == 0);
  traffic.add("POSE", bytes, sizeof bytes, 10, 0);  // its sender began anew
  CHECK(traffic.channels().at("POSE").missing == 3);
}

TEST_CASE("invented channels do not grow without bound") {
  Traffic traffic;
  for (int i = 0; i < 10'000; ++i) traffic.add("CHANNEL_" + std::to_string(i), "x", 1, 0.001 * i);
  CHECK(traffic.channels().size() == Traffic::kMostChannels);
}

TEST_CASE("a message is told in words, names cannot steer the terminal, rubbish is shown as bytes") {
  room_list_t list{};
  list.version = list.nchunks = list.nrooms = 1;
  list.rooms.resize(1);
  list.rooms[0].id = 7;
  list.rooms[0].name = "Hall\x1b[2J";
  room_event_t merge{};
  merge.kind = room_event_t::MERGE;
  merge.before = {7, 9}, merge.nbefore = 2;
  merge.after = {7}, merge.nafter = 1;
  list.events = {merge}, list.nevents = 1;
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(list.getEncodedSize()));
  list.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  std::string all;
  for (const std::string& line : describe_message(channel::kRooms, bytes)) all += line + "\n";
  CHECK_THAT(all, Catch::Contains("room 7") && Catch::Contains("Hall?[2J") && Catch::Contains("rooms 7 9 merged into 7"));
  bytes.resize(bytes.size() - 1);
  CHECK_THAT(describe_message(channel::kRooms, bytes)[0], Catch::Contains("bytes:"));
  CHECK(message_number(channel::kPose, bytes.data(), bytes.size()) == -1);
}

}  // namespace
}  // namespace modslam
