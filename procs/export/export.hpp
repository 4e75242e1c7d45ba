// SPDX-License-Identifier: BSD-3-Clause
/// @file The semantic map for other programs: GIS (GeoTIFF), CAD (DXF). GDAL writes both.
#pragma once
#include <opencv2/core.hpp>
#include <string>

#include "common/maps/mosaic.hpp"
#include "common/semantics/types.hpp"

namespace modslam {

/// What each cell of a map is. Row 0 lowest y, as in MapImage; 0: nothing.
struct SemanticRasters {
  cv::Mat1i occupancy;  ///< -1 unknown, 0 free, 100 occupied
  cv::Mat1i rooms, doors, walls, objects;  ///< ids; walls: occupied cells within 0.15 m of one (the static contours)
};
SemanticRasters rasterise(const SemanticLayers& layers, const MapImage& map);

/// Bands occupancy, rooms, doors, walls, objects (32 bit), placed in map metres, row 0 highest y.
/// @throws std::runtime_error naming the file when GDAL cannot write it, or the map is empty.
void write_geotiff(const std::string& path, const SemanticLayers& layers, const MapImage& map);

/// Layers WALLS, DOORS (lines), ROOMS, OBJECTS (closed outlines), NAMES (texts), in metres.
/// @throws std::runtime_error naming the file when GDAL cannot write it.
void write_dxf(const std::string& path, const SemanticLayers& layers);

}  // namespace modslam
