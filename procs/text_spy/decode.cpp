// SPDX-License-Identifier: BSD-3-Clause
#include "procs/text_spy/decode.hpp"

#include <bot_core/planar_lidar_t.hpp>
#include <bot_core/pose_t.hpp>
#include <array>
#include <cstdio>
#include <modslam/answer_t.hpp>
#include <modslam/command_t.hpp>
#include <modslam/door_list_t.hpp>
#include <modslam/graph_node_t.hpp>
#include <modslam/graph_update_t.hpp>
#include <modslam/loop_closure_t.hpp>
#include <modslam/map_tile_t.hpp>
#include <modslam/object_list_t.hpp>
#include <modslam/place_list_t.hpp>
#include <modslam/query_t.hpp>
#include <modslam/playback_t.hpp>
#include <modslam/pose_estimate_t.hpp>
#include <modslam/process_status_t.hpp>
#include <modslam/room_list_t.hpp>
#include <modslam/scan_match_t.hpp>
#include <modslam/sensor_info_t.hpp>
#include <modslam/wall_list_t.hpp>
#include <optional>

#include "common/bus/channels.hpp"

namespace modslam {
namespace {

using Lines = std::vector<std::string>;

template <class... Values>
std::string line(const char* format, Values... values) {
  char text[400];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}
std::string triple(const char* name, const double (&v)[3]) {
  return line("%-12s %.3f  %.3f  %.3f", name, v[0], v[1], v[2]);
}
std::string time_line(std::int64_t utime) {
  return line("%-12s %.6f s", "utime", static_cast<double>(utime) * 1e-6);
}

template <class Message>
std::optional<Message> decoded(const void* bytes, std::size_t size) {
  try {
    Message m{};
    if (m.decode(bytes, 0, static_cast<int>(size)) == static_cast<int>(size)) return m;
  } catch (const std::exception&) {  // a wild array length
  }
  return std::nullopt;
}

Lines words(const bot_core::planar_lidar_t& m) {
  std::string ranges = "ranges      ";
  for (std::size_t i = 0; i < m.ranges.size(); i += m.ranges.size() / 8 + 1)
    ranges += line(" %.2f", static_cast<double>(m.ranges[i]));
  return {time_line(m.utime),
          line("%-12s %d from %.3f rad, step %.5f rad", "beams", m.nranges,
               static_cast<double>(m.rad0), static_cast<double>(m.radstep)),
          ranges + " ... m"};
}
Lines words(const bot_core::pose_t& m) {
  return {time_line(m.utime), triple("pos", m.pos),
          line("%-12s %.4f  %.4f  %.4f  %.4f", "orientation", m.orientation[0], m.orientation[1],
               m.orientation[2], m.orientation[3]),
          triple("rates", m.rotation_rate)};
}
Lines words(const scan_match_t& m) {
  return {time_line(m.utime),
          line("%-12s %lld of track %lld, verdict %d", "seq", static_cast<long long>(m.seq),
               static_cast<long long>(m.track), m.verdict),
          triple("T_from_to", m.T_from_to),
          line("%-12s overlap %.2f, chi2 %.2f, ambiguity %.2f, free violation %.2f", "figures",
               m.overlap, m.chi2, m.ambiguity, m.free_violation)};
}
Lines words(const pose_estimate_t& m) {
  return {
      time_line(m.utime),
      line("%-12s %lld, epoch %lld, node %lld, verdict %d", "seq", static_cast<long long>(m.seq),
           static_cast<long long>(m.epoch), static_cast<long long>(m.node_id), m.verdict),
      triple("T_map_base", m.T_map_base)};
}
Lines words(const graph_node_t& m) {
  return {time_line(m.utime), line("%-12s %lld", "id", static_cast<long long>(m.id)),
          triple("T_map_base", m.T_map_base), line("%-12s %d beams", "scan", m.scan.nranges)};
}
Lines words(const graph_update_t& m) {
  return {time_line(m.utime),
          line("%-12s %lld, epoch %lld, chunk %d of %d%s", "seq", static_cast<long long>(m.seq),
               static_cast<long long>(m.epoch), m.chunk, m.nchunks, m.snapshot ? ", snapshot" : ""),
          line("%-12s %lld; %d edges added, %d taken back, %d poses moved", "nodes",
               static_cast<long long>(m.nnodes), m.nedges, m.nretracted, m.nposes)};
}
Lines words(const loop_closure_t& m) {
  return {time_line(m.utime),
          line("%-12s %lld: %lld to %lld, verdict %d", "seq", static_cast<long long>(m.seq),
               static_cast<long long>(m.from_node), static_cast<long long>(m.to_node), m.verdict),
          triple("T_from_to", m.T_from_to),
          line("%-12s score %.2f, overlap %.2f, innovation %.1f", "figures", m.score, m.overlap,
               m.innovation)};
}
Lines words(const map_tile_t& m) {
  return {time_line(m.utime),
          line("%-12s %d, %d, version %lld", "tile", m.tile_x, m.tile_y,
               static_cast<long long>(m.version)),
          line("%-12s %d x %d of %.3f m, %d bytes packed", "cells", m.ncells, m.ncells,
               m.resolution_m, m.nbytes)};
}
Lines words(const process_status_t& m) {
  return {
      time_line(m.utime),
      line("%-12s %s %s, pid %d, state %d", "process", m.name.c_str(), m.version.c_str(), m.pid,
           m.state),
      line("%-12s %.1f ms, 99 %% within %.1f ms; %.0f MB", "latency",
           static_cast<double>(m.latency_p50_us) / 1e3, static_cast<double>(m.latency_p99_us) / 1e3,
           static_cast<double>(m.memory_kb) / 1024),
      line("%-12s %s", "words", m.words.c_str())};
}
Lines words(const sensor_info_t& m) { return {time_line(m.utime)}; }
Lines words(const command_t& m) {
  return {line("%-12s '%s' to '%s'", "verb", m.verb.c_str(), m.target.c_str())};
}
Lines words(const playback_t& m) {
  return {line("%-12s %.1f of %.1f s at %g times real time%s", "position", m.position_s, m.length_s,
               m.speed, m.paused ? ", paused" : "")};
}

template <class List>
Lines list_head(const List& m) {
  return {time_line(m.utime), line("%-12s %lld, chunk %d of %d", "version",
                                   static_cast<long long>(m.version), m.chunk, m.nchunks)};
}
std::string numbers(const std::vector<std::int64_t>& ids) {
  std::string all;
  for (const std::int64_t id : ids) all += " " + std::to_string(id);
  return all;
}
Lines words(const room_list_t& m) {
  Lines all = list_head(m);
  for (const room_t& r : m.rooms)
    all.push_back(line("room %-7lld %s, %.1f m2, explored %.0f %%", static_cast<long long>(r.id),
                       r.name.c_str(), r.area_m2, 100 * r.explored));
  for (const room_event_t& e : m.events)
    all.push_back(line("rooms%s %s%s", numbers(e.before).c_str(), e.kind == room_event_t::MERGE ? "merged into" : "split into", numbers(e.after).c_str()));
  return all;
}
Lines words(const door_list_t& m) {
  Lines all = list_head(m);
  for (const door_t& d : m.doors)
    all.push_back(line("door %-7lld between %lld and %lld, %.2f m, state %d",
                       static_cast<long long>(d.id), static_cast<long long>(d.room_a),
                       static_cast<long long>(d.room_b), d.width_m, d.state));
  return all;
}
std::string end_words(const wall_t& w, int k) {
  return w.end_seen[k] ? line("%.2f m", w.sigma_along_m[k]) : "what was not seen";
}
Lines words(const wall_list_t& m) {
  Lines all = list_head(m);
  for (const wall_t& w : m.walls)
    all.push_back(line("wall %-7lld %.2f, %.2f to %.2f, %.2f m, ends to %s and %s", static_cast<long long>(w.id),
                       w.a[0], w.a[1], w.b[0], w.b[1], end_words(w, 0).c_str(), end_words(w, 1).c_str()));
  return all;
}
Lines words(const object_list_t& m) {
  Lines all = list_head(m);
  for (const object_t& o : m.objects)
    all.push_back(line("object %-5lld %s, %.0f %% sure, %.2f m2", static_cast<long long>(o.id),
                       o.class_name.c_str(), 100 * o.class_confidence, o.area_m2));
  return all;
}

Lines words(const place_list_t& m) {
  Lines all = list_head(m);
  std::array<int, 3> counts{};
  for (const std::int8_t kind : m.kind)
    if (kind >= 0 && kind < 3) ++counts[static_cast<std::size_t>(kind)];
  all.push_back(line("%-12s from %lld: %d in rooms, %d in corridors, %d in doorways", "nodes",
                     static_cast<long long>(m.first_node), counts[0], counts[1], counts[2]));
  return all;
}
Lines words(const query_t& m) {
  return {line("%-12s %d of %s: '%s' to '%s'", "query", m.kind, m.requester.c_str(), m.from.c_str(),
               m.to.c_str())};
}
Lines words(const answer_t& m) {
  return {line("%-12s to %s: %s", "answer", m.requester.c_str(), m.words.c_str())};
}

/// Tries the one type that a fingerprint belongs to.
template <class Message>
bool take(const std::vector<std::uint8_t>& bytes, Lines& lines) {
  const std::optional<Message> m = decoded<Message>(bytes.data(), bytes.size());
  if (m) lines = words(*m);
  return m.has_value();
}
template <class... Messages>
bool take_any(const std::vector<std::uint8_t>& bytes, Lines& lines) {
  return (take<Messages>(bytes, lines) || ...);
}

std::string beginning(const std::vector<std::uint8_t>& bytes) {
  std::string text = line("%zu bytes:", bytes.size());
  for (std::size_t i = 0; i < std::min<std::size_t>(24, bytes.size()); ++i)
    text += line(" %02x", bytes[i]);
  return text;
}

/// Names are foreign text: what could steer a terminal is replaced.
void make_plain(Lines& lines) {
  for (std::string& text : lines)
    for (char& c : text)
      if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
}

}  // namespace

std::vector<std::string> describe_message(const std::string&,
                                          const std::vector<std::uint8_t>& bytes) {
  Lines lines;
  if (!take_any<bot_core::planar_lidar_t, bot_core::pose_t, scan_match_t, pose_estimate_t,
                graph_node_t, graph_update_t, loop_closure_t, map_tile_t, process_status_t,
                sensor_info_t, command_t, playback_t, room_list_t, door_list_t, wall_list_t,
                object_list_t, place_list_t, query_t, answer_t>(bytes, lines))
    lines = {beginning(bytes)};
  make_plain(lines);
  return lines;
}

std::int64_t message_number(const std::string& channel, const void* bytes, std::size_t size) {
  if (channel == channel::kPose)
    if (const auto m = decoded<pose_estimate_t>(bytes, size)) return m->seq;
  if (channel == channel::kScanMatch)
    if (const auto m = decoded<scan_match_t>(bytes, size)) return m->seq;
  if (channel == channel::kNode)
    if (const auto m = decoded<graph_node_t>(bytes, size)) return m->id;
  if (channel == channel::kGraph)
    if (const auto m = decoded<graph_update_t>(bytes, size)) return m->seq;
  if (channel == channel::kLoop)
    if (const auto m = decoded<loop_closure_t>(bytes, size)) return m->seq;
  return -1;
}

}  // namespace modslam
