// SPDX-License-Identifier: BSD-3-Clause
/// @file Maps as the ROS map_server reads them: a trinary picture and the YAML beside it.
#pragma once
#include <string>

#include "common/maps/mosaic.hpp"

namespace modslam {

/// Grey PNG, row 0 highest y: 254 free, 0 occupied, 205 unknown or undecided. An empty map is one
/// unknown pixel.
std::string map_server_png(const MapImage& map);
/// The same picture as binary PGM.
std::string map_server_pgm(const MapImage& map);
std::string map_server_yaml(const MapImage& map, const std::string& image_name);

/// The value of one pixel for a cell.
std::uint8_t map_server_pixel(std::uint8_t cell);

}  // namespace modslam
