// SPDX-License-Identifier: BSD-3-Clause
#include "common/maps/occupancy_map.hpp"

#include <algorithm>
#include <cmath>

namespace modslam {
namespace {

constexpr int kTileShift = BeamCounts::kTileShift, kTileMask = BeamCounts::kTileMask;

}  // namespace

void OccupancyMap::clear() {
  tiles_.clear();
  changed_.clear();
}

/// Scans of one laser point the same way: its directions are computed once.
void OccupancyMap::aim(const Scan& scan) {
  const std::size_t count = scan.ranges_m.size();
  if (directions_.size() == count && aimed_rad0_ == scan.rad0 && aimed_radstep_ == scan.radstep) return;
  aimed_rad0_ = scan.rad0;
  aimed_radstep_ = scan.radstep;
  directions_.resize(count);
  for (std::size_t k = 0; k < count; ++k) directions_[k] = {std::cos(scan.bearing_rad(k)), std::sin(scan.bearing_rad(k))};
}

void OccupancyMap::draw(const Scan& scan, const SensorInfo& sensor, const Pose2& T_map_base, int sign) {
  const Pose2 T_map_laser = T_map_base * sensor.T_base_laser;
  const PointMover to_map(T_map_laser);
  const Eigen::Vector2d eye = T_map_laser.translation() / resolution_m_;
  aim(scan);
  beams_.clear();
  for (std::size_t k = 0; k < scan.ranges_m.size(); ++k) {
    const bool measured = is_return(scan.ranges_m[k], sensor);
    if (!measured && !(sensor.no_return_is_free && scan.ranges_m[k] >= sensor.range_max_m)) continue;
    const double range_m = measured ? static_cast<double>(scan.ranges_m[k]) : sensor.range_max_m;
    const double drawn_m = std::min(range_m, range_limit_m_);
    beams_.push_back({to_map * (drawn_m * directions_[k]) / resolution_m_, measured && range_m <= range_limit_m_});
  }
  for (std::size_t k = 0; k < beams_.size(); k += BeamCounts::kMostBeams) {
    counts_.draw(eye, &beams_[k], &beams_[k] + std::min(BeamCounts::kMostBeams, beams_.size() - k));
    for (const TileIndex& index : counts_.tiles()) counts_.pour(index, sign, tile_to_change(index).passed.data());
  }
  draw_hits(sign);
}

OccupancyMap::Tile& OccupancyMap::tile_to_change(const TileIndex& index) {
  changed_.insert(index);
  return tiles_[index];
}

void OccupancyMap::draw_hits(int sign) {
  TileIndex index;
  Tile* tile = nullptr;  // that of the hit before
  for (const BeamCounts::Beam& beam : beams_) {
    if (!beam.hits) continue;
    const auto [i, j] = beam.end_cell();
    if (const TileIndex here(i >> kTileShift, j >> kTileShift); !tile || here != index) {
      index = here;
      tile = &tile_to_change(index);
    }
    tile->ended[static_cast<std::size_t>(((j & kTileMask) << kTileShift) + (i & kTileMask))] += sign;
  }
}

std::set<OccupancyMap::TileIndex> OccupancyMap::take_changed() {
  std::set<TileIndex> out;
  std::swap(out, changed_);
  return out;
}

std::vector<OccupancyMap::TileIndex> OccupancyMap::tiles() const {
  std::vector<TileIndex> out;
  for (const auto& [index, tile] : tiles_) out.push_back(index);
  return out;
}

void OccupancyMap::classes(const TileIndex& index, std::uint8_t* out) const {
  const auto tile = tiles_.find(index);
  for (std::size_t k = 0; k < kTileCells * kTileCells; ++k) {
    out[k] = 0;
    if (tile == tiles_.end()) continue;
    const std::int32_t ended = tile->second.ended[k], passed = tile->second.passed[k];
    if (ended > 0 || passed > 0) out[k] = 765 * ended + 1 >= 253 * passed ? 255 : 1;  // render() >= 128, without a division
  }
}

std::vector<std::uint8_t> OccupancyMap::render(const TileIndex& index) const {
  std::vector<std::uint8_t> out(kTileCells * kTileCells, 0);
  const auto tile = tiles_.find(index);
  if (tile == tiles_.end()) return out;
  // A beam that ends says more than one that passes: at grazing angles many pass the cells of a wall.
  constexpr double kEndedWeight = 3.0;
  for (std::size_t k = 0; k < out.size(); ++k) {
    const std::int32_t ended = tile->second.ended[k], passed = tile->second.passed[k];
    if (ended <= 0 && passed <= 0) continue;
    const double p = (kEndedWeight * ended + 0.5) / (kEndedWeight * ended + passed + 1.0);
    out[k] = static_cast<std::uint8_t>(1.5 + 254 * std::min(1.0, std::max(0.0, p)));
  }
  return out;
}

}  // namespace modslam
