// SPDX-License-Identifier: BSD-3-Clause
/// @file Reads a finished grid map: a picture and the YAML beside it, as ROS's map_server writes them.
#pragma once
#include <string>

#include "common/maps/mosaic.hpp"

namespace modslam {

/// Cells hold 0 unknown, 1 free, 255 occupied. A picture that the YAML names but that is not there is looked for as .png.
/// @throws std::runtime_error naming file and key: missing, not a number, out of bounds, a turned origin, no picture.
MapImage read_grid_map(const std::string& yaml_path);

}  // namespace modslam
