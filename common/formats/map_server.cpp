// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/map_server.hpp"

#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

namespace modslam {
namespace {

constexpr std::uint8_t kFree = 254, kOccupied = 0, kUnknown = 205;
constexpr double kOccupiedFrom = 0.6, kFreeUpTo = 0.4;  // probability; between them nothing is said

std::string packed_as(const char* extension, const MapImage& map) {
  cv::Mat picture(std::max(map.height, 1), std::max(map.width, 1), CV_8UC1, cv::Scalar(kUnknown));
  for (int row = 0; row < map.height; ++row)
    for (int column = 0; column < map.width; ++column)
      picture.at<std::uint8_t>(map.height - 1 - row, column) =
          map_server_pixel(map.at(column, row));
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(extension, picture, bytes))
    throw std::runtime_error(std::string("the map cannot be packed as ") + extension);
  return {bytes.begin(), bytes.end()};
}

}  // namespace

std::uint8_t map_server_pixel(std::uint8_t cell) {
  if (cell == 0) return kUnknown;
  const double occupied = (cell - 1) / 254.0;
  return occupied >= kOccupiedFrom ? kOccupied : occupied <= kFreeUpTo ? kFree : kUnknown;
}

std::string map_server_png(const MapImage& map) { return packed_as(".png", map); }
std::string map_server_pgm(const MapImage& map) { return packed_as(".pgm", map); }

std::string map_server_yaml(const MapImage& map, const std::string& image_name) {
  char text[512];
  std::snprintf(text, sizeof text,
                "image: %s\nmode: trinary\nresolution: %.9g\norigin: [%.9g, %.9g, 0]\nnegate: 0\n"
                "occupied_thresh: 0.65\nfree_thresh: 0.196\n",
                image_name.c_str(), map.empty() ? 0.05 : map.resolution_m, map.origin_m.x(),
                map.origin_m.y());
  return text;
}

}  // namespace modslam
