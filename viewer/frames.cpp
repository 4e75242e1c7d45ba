// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/frames.hpp"

#include <algorithm>

#include "common/bus/bus.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/semantic_messages.hpp"

namespace modslam {
namespace {

using nlohmann::json;

constexpr double kLargest = 1e9;

/// Three digits (millimetres) are enough to look at.
double rounded(double value) {
  return std::round(std::clamp(value, -kLargest, kLargest) * 1000.0) / 1000.0;
}

double number(double value, const char* what) {
  if (!(std::abs(value) <= kLargest))
    throw BadMessage(std::string(what) + " with an impossible number");
  return rounded(value);
}

json point(const double (&p)[2], const char* what) {
  return {number(p[0], what), number(p[1], what)};
}

/// Corners flat: x0 y0 x1 y1 ...
json outline(const std::vector<double>& x, const std::vector<double>& y, const char* what) {
  if (x.size() < 3) throw BadMessage(std::string(what) + " with less than 3 corners");
  json flat = json::array();
  for (std::size_t i = 0; i < x.size(); ++i) {
    flat.push_back(number(x[i], what));
    flat.push_back(number(y[i], what));
  }
  return flat;
}

/// @param k  0: at a, 1: at b
json wall_end(const wall_t& w, int k) {
  return {{"across_m", number(w.sigma_across_m[k], "wall")}, {"along_m", number(w.sigma_along_m[k], "wall")}, {"seen", w.end_seen[k] != 0}};
}

json counts_json(const std::vector<channel_count_t>& counts) {
  json list = json::array();
  for (const channel_count_t& c : counts)
    list.push_back(
        {{"channel", c.channel}, {"received", c.received}, {"bad", c.bad}, {"gaps", c.gaps}});
  return list;
}

}  // namespace

FramePtr text_frame(const json& content) {
  Frame frame{false, content.dump(-1, ' ', false, json::error_handler_t::replace)};
  frame.bytes.shrink_to_fit();  // it may be kept, and text grows by doubling
  return std::make_shared<Frame>(std::move(frame));
}

json walls_json(const std::vector<wall_list_t>& chunks) {
  json items = json::array();
  for (const wall_list_t& chunk : chunks)
    for (const wall_t& w : chunk.walls)
      items.push_back({{"id", w.id},
                       {"a", point(w.a, "wall")},
                       {"b", point(w.b, "wall")},
                       {"length_m", number(std::hypot(w.b[0] - w.a[0], w.b[1] - w.a[1]), "wall")},
                       {"evidence", number(w.evidence, "wall")},
                       {"sigma_m", number(w.sigma_m, "wall")},
                       {"ends", {wall_end(w, 0), wall_end(w, 1)}}});
  return {{"stream", "walls"}, {"items", std::move(items)}};
}

json rooms_json(const std::vector<room_list_t>& chunks) {
  json items = json::array();
  for (const room_list_t& chunk : chunks)
    for (const room_t& r : chunk.rooms)
      items.push_back({{"id", r.id},
                       {"name", r.name},
                       {"type", r.type == room_t::CORRIDOR ? "corridor" : "room"},
                       {"area_m2", number(r.area_m2, "room")},
                       {"explored", number(r.explored, "room")},
                       {"evidence", number(r.evidence, "room")},
                       {"outline", outline(r.x, r.y, "room")}});
  return {{"stream", "rooms"}, {"items", std::move(items)}};
}

json doors_json(const std::vector<door_list_t>& chunks) {
  json items = json::array();
  for (const door_list_t& chunk : chunks)
    for (const door_t& d : chunk.doors)
      items.push_back({{"id", d.id},
                       {"a", point(d.a, "door")},
                       {"b", point(d.b, "door")},
                       {"width_m", number(d.width_m, "door")},
                       {"evidence", number(d.evidence, "door")},
                       {"rooms", {d.room_a, d.room_b}},
                       {"state", d.state == door_t::OPEN     ? "open"
                                 : d.state == door_t::CLOSED ? "closed"
                                                             : "unknown"}});
  return {{"stream", "doors"}, {"items", std::move(items)}};
}

json objects_json(const std::vector<object_list_t>& chunks) {
  json items = json::array();
  for (const object_list_t& chunk : chunks)
    for (const object_t& o : chunk.objects)
      items.push_back({{"id", o.id},
                       {"class", o.class_name},
                       {"class_confidence", number(o.class_confidence, "object")},
                       {"area_m2", number(o.area_m2, "object")},
                       {"evidence", number(o.evidence, "object")},
                       {"first_utime", o.first_utime},
                       {"last_utime", o.last_utime},
                       {"outline", outline(o.x, o.y, "object")}});
  return {{"stream", "objects"}, {"items", std::move(items)}};
}

json places_json(const std::vector<place_list_t>& chunks) {
  json items = json::array();
  for (const place_list_t& chunk : chunks)
    for (const Place& place : from_message(chunk)) {
      if (static_cast<std::int64_t>(items.size()) != 2 * place.node) throw BadMessage("places leave out nodes");
      items.push_back(static_cast<int>(place.kind));
      items.push_back(std::lround(100 * place.confidence));
    }
  return {{"stream", "places"}, {"items", std::move(items)}};
}

json pose_json(const pose_estimate_t& message) {
  const Pose2 pose = to_pose(message.T_map_base);
  const Eigen::Matrix3d cov = to_matrix(message.covariance);
  return {{"stream", "pose"},
          {"utime", message.utime},
          {"seq", message.seq},
          {"epoch", message.epoch},
          {"verdict", message.verdict},
          {"pose", {number(pose.x, "pose"), number(pose.y, "pose"), number(pose.heading, "pose")}},
          {"covariance_xy", {cov(0, 0), cov(0, 1), cov(1, 1)}},
          {"sigma_heading_rad", std::sqrt(std::max(0.0, cov(2, 2)))}};
}

json scan_json(const Scan& scan, const SensorInfo& sensor, const Pose2& T_map_base) {
  json flat = json::array();
  for (const ScanPoint& seen : points_base(scan, sensor)) {
    const Eigen::Vector2d p = T_map_base * seen.p;
    flat.push_back(rounded(p.x()));
    flat.push_back(rounded(p.y()));
  }
  return {{"stream", "scan"}, {"utime", scan.utime}, {"points", std::move(flat)}};
}

json poses_json(const char* stream, std::size_t first,
                const std::vector<std::array<double, 3>>& poses) {
  json flat = json::array();
  for (const auto& pose : poses)
    for (const double value : pose) flat.push_back(rounded(value));
  return {{"stream", stream}, {"first", first}, {"poses", std::move(flat)}};
}

std::array<double, 3> ellipse(const Eigen::Matrix3d& covariance) {
  const double xx = covariance(0, 0), xy = covariance(0, 1), yy = covariance(1, 1);
  const double mean = (xx + yy) / 2, spread = std::hypot((xx - yy) / 2, xy);
  return {std::sqrt(std::max(0.0, mean + spread)), std::sqrt(std::max(0.0, mean - spread)),
          0.5 * std::atan2(2 * xy, xx - yy)};
}

json playback_json(const playback_t& message, std::int64_t seen_ms) {
  return {{"stream", "playback"},
          {"position_s", number(message.position_s, "playback")},
          {"length_s", number(message.length_s, "playback")},
          {"speed", number(message.speed, "playback")},
          {"paused", message.paused != 0},
          {"ended", message.ended != 0},
          {"seen_ms", seen_ms}};
}

json counts_json(const std::map<std::string, ChannelCount>& counts) {
  json list = json::array();
  for (const auto& [name, count] : counts)
    list.push_back({{"channel", name},
                    {"received", count.received},
                    {"bad", count.bad},
                    {"gaps", count.gaps}});
  return list;
}

json status_json(const process_status_t& message, std::int64_t seen_ms) {
  static const char* const kStates[] = {"invalid", "running", "troubled", "finished", "stopped"};
  const bool known = message.state >= 0 && message.state <= process_status_t::STOPPED;
  return {{"stream", "status"},
          {"name", message.name},
          {"version", message.version},
          {"pid", message.pid},
          {"state", kStates[known ? message.state : 0]},
          {"utime", message.utime},
          {"seen_ms", seen_ms},
          {"inputs", counts_json(message.inputs)},
          {"outputs", counts_json(message.outputs)},
          {"latency_p50_us", message.latency_p50_us},
          {"latency_p99_us", message.latency_p99_us},
          {"memory_kb", message.memory_kb},
          {"words", message.words}};
}

}  // namespace modslam
