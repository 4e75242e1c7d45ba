// SPDX-License-Identifier: BSD-3-Clause
/// @file What a page is told: messages as JSON text, map tiles as bytes. README.md lists the
/// streams.
///
/// Numbers that are not finite and sizes that disagree throw BadMessage; names are foreign text,
/// they are repaired to valid UTF-8 and escaped by the JSON library. Metres are rounded to
/// millimetres.
#pragma once
#include <array>
#include <modslam/door_list_t.hpp>
#include <modslam/map_tile_t.hpp>
#include <modslam/object_list_t.hpp>
#include <modslam/place_list_t.hpp>
#include <modslam/playback_t.hpp>
#include <modslam/pose_estimate_t.hpp>
#include <modslam/process_status_t.hpp>
#include <modslam/room_list_t.hpp>
#include <modslam/wall_list_t.hpp>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/geometry/pose2.hpp"
#include "common/scan/scan.hpp"
#include "viewer/outbox.hpp"

namespace modslam {

FramePtr text_frame(const nlohmann::json& content);

nlohmann::json walls_json(const std::vector<wall_list_t>& chunks);
nlohmann::json rooms_json(const std::vector<room_list_t>& chunks);
nlohmann::json doors_json(const std::vector<door_list_t>& chunks);
nlohmann::json objects_json(const std::vector<object_list_t>& chunks);
/// Kinds and confidences (in per cent) of the nodes, flat: kind0 confidence0 kind1 ...
nlohmann::json places_json(const std::vector<place_list_t>& chunks);

nlohmann::json pose_json(const pose_estimate_t& message);
/// The returns of a scan in the map frame, flat: x0 y0 x1 y1 ...
nlohmann::json scan_json(const Scan& scan, const SensorInfo& sensor, const Pose2& T_map_base);
/// Poses flat: x0 y0 heading0 x1 ...; `first` is the number of the first one.
nlohmann::json poses_json(const char* stream, std::size_t first,
                          const std::vector<std::array<double, 3>>& poses);
/// Half axes [m] of the ellipse that a covariance's x and y span at one sigma, and the heading
/// [rad] of the longer one.
std::array<double, 3> ellipse(const Eigen::Matrix3d& covariance);
/// @param seen_ms  when it was received, on the clock that the stream `clock` tells.
nlohmann::json status_json(const process_status_t& message, std::int64_t seen_ms);

/// Where the replay of a log stands. @throws BadMessage on impossible numbers.
nlohmann::json playback_json(const playback_t& message, std::int64_t seen_ms);
nlohmann::json counts_json(const std::map<std::string, ChannelCount>& counts);

/// The cells of a tile, row 0 lowest y. @throws BadMessage on an unknown encoding, a size out of
/// bounds or data that do not unpack to exactly ncells^2 bytes.
std::vector<std::uint8_t> unpack_tile(const map_tile_t& tile);
/// Header of 24 bytes, little endian (int32 tile_x, tile_y, ncells, version; float64 resolution_m),
/// then the cells as they came: zlib. Unpacks once to be sure that the page can.
FramePtr tile_frame(const map_tile_t& tile);

}  // namespace modslam
