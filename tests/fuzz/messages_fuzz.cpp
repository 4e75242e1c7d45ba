// SPDX-License-Identifier: BSD-3-Clause
/// The first byte chooses a message type; the rest is its body. Whatever decodes must encode and decode again, and convert or be refused.
#include <bot_core/planar_lidar_t.hpp>
#include <bot_core/pose_t.hpp>
#include <cstdlib>
#include <modslam/command_t.hpp>
#include <modslam/door_list_t.hpp>
#include <modslam/estimator_anchor_t.hpp>
#include <modslam/estimator_state_t.hpp>
#include <modslam/graph_node_t.hpp>
#include <modslam/graph_update_t.hpp>
#include <modslam/loop_closure_t.hpp>
#include <modslam/loop_search_t.hpp>
#include <modslam/map_tile_t.hpp>
#include <modslam/matcher_state_t.hpp>
#include <modslam/object_list_t.hpp>
#include <modslam/parameters_t.hpp>
#include <modslam/place_list_t.hpp>
#include <modslam/playback_t.hpp>
#include <modslam/pose_estimate_t.hpp>
#include <modslam/process_status_t.hpp>
#include <modslam/repeat_request_t.hpp>
#include <modslam/repeat_t.hpp>
#include <modslam/room_list_t.hpp>
#include <modslam/scan_match_t.hpp>
#include <modslam/sim_info_t.hpp>
#include <modslam/sim_state_t.hpp>
#include <modslam/sync_request_t.hpp>
#include <modslam/wall_list_t.hpp>
#include <new>
#include <stdexcept>

#include "common/bus/bus.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/estimator_session.hpp"
#include "common/bus/graph_mirror.hpp"
#include "common/bus/semantic_messages.hpp"
#include "common/bus/topology_messages.hpp"

using namespace modslam;

namespace {

template <class Message>
void convert(const Message&) {}
void convert(const bot_core::planar_lidar_t& m) { to_message(to_scan(m)); }
void convert(const bot_core::pose_t& m) { to_message(to_timed_pose(m)); }
void convert(const sensor_info_t& m) { to_sensor_info(m); }
void convert(const loop_closure_t& m) { to_message(to_loop(m), 0, 0); }
void convert(const graph_node_t& m) {
  convert(m.sensor);
  convert(m.scan);
  to_pose(m.T_map_base);
}
void convert(const graph_update_t& m) {
  for (const graph_edge_t& edge : m.edges) to_edge(edge);
}
void convert(const place_list_t& m) { from_message(m); }
void convert(const query_t& m) { answer(Topology(), m, 0); }
void convert(const scan_match_t& m) { to_matrix(m.information); }

template <class Message>
void take(const std::vector<std::uint8_t>& bytes) {
  const int size = static_cast<int>(bytes.size());
  Message message{};
  try {
    if (message.decode(bytes.data(), 0, size) != size) return;
    // Less than getEncodedSize() when a text holds a zero: LCM ends it there.
    std::vector<std::uint8_t> again(static_cast<std::size_t>(message.getEncodedSize()));
    const int written = message.encode(again.data(), 0, static_cast<int>(again.size()));
    Message twin{};
    if (written < 0 || twin.decode(again.data(), 0, written) != written) std::abort();
    convert(message);
  } catch (const BadMessage&) {
  } catch (const std::length_error&) {  // Bus refuses what throws these two
  } catch (const std::bad_alloc&) {
  }
}

using Take = void (*)(const std::vector<std::uint8_t>&);
struct Type {
  std::int64_t hash;
  Take take;
};
template <class Message>
Type type() {
  return {Message::getHash(), take<Message>};
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Type kTypes[] = {
      type<bot_core::planar_lidar_t>(), type<bot_core::pose_t>(),    type<command_t>(),         type<door_list_t>(),
      type<estimator_anchor_t>(),       type<estimator_state_t>(),        type<graph_node_t>(),        type<graph_update_t>(),    type<loop_closure_t>(),
      type<loop_search_t>(),            type<map_tile_t>(),          type<matcher_state_t>(),   type<object_list_t>(),
      type<parameters_t>(),             type<pose_estimate_t>(),     type<process_status_t>(),  type<room_list_t>(),
      type<scan_match_t>(),             type<sensor_info_t>(),       type<sim_info_t>(),        type<sim_state_t>(),
      type<sync_request_t>(),           type<wall_list_t>(),         type<place_list_t>(),      type<query_t>(),           type<answer_t>(),
      type<repeat_request_t>(),         type<repeat_t>(),            type<playback_t>()};
  if (size == 0) return 0;
  const Type& chosen = kTypes[data[0] % (sizeof kTypes / sizeof *kTypes)];
  std::vector<std::uint8_t> bytes;  // the right fingerprint, else nothing would get past it
  for (int shift = 56; shift >= 0; shift -= 8) bytes.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(chosen.hash) >> shift));
  bytes.insert(bytes.end(), data + 1, data + size);
  chosen.take(bytes);
  return 0;
}
