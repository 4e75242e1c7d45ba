// SPDX-License-Identifier: BSD-3-Clause
#include <cpl_error.h>
#include <gdal_priv.h>

#include <cmath>
#include <limits>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "procs/export/export.hpp"

namespace modslam {
namespace {

using Ring = std::vector<Eigen::Vector2d>;

constexpr double kWallReach_m = 0.15, kDoorThickness_m = 0.15;

int id_of(std::int64_t id) { return static_cast<int>(std::min<std::int64_t>(id, std::numeric_limits<int>::max())); }

class Cells {
 public:
  explicit Cells(const MapImage& map) : map_(map) {}

  cv::Point of(const Eigen::Vector2d& p) const {
    const Eigen::Vector2d c = (p - map_.origin_m) / map_.resolution_m;
    const auto bounded = [](double v) { return static_cast<int>(std::floor(std::max(-1e6, std::min(1e6, v)))); };
    return {bounded(c.x()), bounded(c.y())};
  }
  void fill(cv::Mat1i& raster, const Ring& outline, int value) const {
    std::vector<cv::Point> ring;
    for (const Eigen::Vector2d& p : outline) ring.push_back(of(p));
    if (ring.size() > 2) cv::fillPoly(raster, std::vector<std::vector<cv::Point>>{ring}, cv::Scalar(value));
  }
  void stroke(cv::Mat1i& raster, const Eigen::Vector2d& a, const Eigen::Vector2d& b, double width_m, int value) const {
    cv::line(raster, of(a), of(b), cv::Scalar(value), std::max(1, static_cast<int>(std::lround(width_m / map_.resolution_m))));
  }

 private:
  const MapImage& map_;
};

int occupancy_of(std::uint8_t cell) { return cell == 0 ? -1 : cell < 128 ? 0 : 100; }

}  // namespace

SemanticRasters rasterise(const SemanticLayers& layers, const MapImage& map) {
  const Cells cells(map);
  const cv::Size size(map.width, map.height);
  SemanticRasters out{cv::Mat1i(size, -1), cv::Mat1i(size, 0), cv::Mat1i(size, 0), cv::Mat1i(size, 0), cv::Mat1i(size, 0)};
  for (int row = 0; row < map.height; ++row)
    for (int column = 0; column < map.width; ++column) out.occupancy(row, column) = occupancy_of(map.at(column, row));
  for (const Room& room : layers.rooms) cells.fill(out.rooms, room.outline, id_of(room.id));
  for (const Door& door : layers.doors) cells.stroke(out.doors, door.a, door.b, kDoorThickness_m, id_of(door.id));
  for (const Wall& wall : layers.walls) cells.stroke(out.walls, wall.a, wall.b, 2 * kWallReach_m, id_of(wall.id));
  out.walls.setTo(0, out.occupancy != 100);
  for (const Object& object : layers.objects) cells.fill(out.objects, object.outline, id_of(object.id));
  return out;
}

void write_geotiff(const std::string& path, const SemanticLayers& layers, const MapImage& map) {
  if (map.empty()) throw std::runtime_error(path + ": the map is empty");
  const SemanticRasters rasters = rasterise(layers, map);
  const std::pair<const char*, const cv::Mat1i*> bands[] = {{"occupancy", &rasters.occupancy}, {"rooms", &rasters.rooms}, {"doors", &rasters.doors},
                                                            {"walls", &rasters.walls}, {"objects", &rasters.objects}};
  GDALAllRegister();
  CPLErrorHandlerPusher quiet(CPLQuietErrorHandler);
  const auto fail = [&] { return std::runtime_error(path + ": cannot be written: " + CPLGetLastErrorMsg()); };
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  if (!driver) throw std::runtime_error(path + ": this GDAL writes no GeoTIFF");
  const char* const options[] = {"COMPRESS=DEFLATE", nullptr};
  const std::unique_ptr<GDALDataset> file(
      driver->Create(path.c_str(), map.width, map.height, static_cast<int>(std::size(bands)), GDT_Int32, const_cast<char**>(options)));
  if (!file) throw fail();
  double place[6] = {map.origin_m.x(), map.resolution_m, 0, map.origin_m.y() + map.height * map.resolution_m, 0, -map.resolution_m};
  file->SetGeoTransform(place);
  int number = 0;
  for (const auto& [name, raster] : bands) {
    cv::Mat1i upright;
    cv::flip(*raster, upright, 0);
    GDALRasterBand* band = file->GetRasterBand(++number);
    band->SetDescription(name);
    if (band->RasterIO(GF_Write, 0, 0, map.width, map.height, upright.data, map.width, map.height, GDT_Int32, 0, 0) != CE_None) throw fail();
  }
}

}  // namespace modslam
