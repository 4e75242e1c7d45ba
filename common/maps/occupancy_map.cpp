// SPDX-License-Identifier: BSD-3-Clause
#include "common/maps/occupancy_map.hpp"

#include <cmath>

namespace modslam {
namespace {

constexpr int kTileShift = 6, kTileMask = OccupancyMap::kTileCells - 1;
static_assert(OccupancyMap::kTileCells == 1 << kTileShift, "cells find their tile by shifting");

}  // namespace

void OccupancyMap::clear() {
  tiles_.clear();
  changed_.clear();
  last_tile_ = nullptr;
}

inline OccupancyMap::Cell& OccupancyMap::cell(int i, int j) {
  const int x = i >> kTileShift, y = j >> kTileShift;  // rounds down, for negative cells too
  if (!last_tile_ || x != last_index_.first || y != last_index_.second) {
    last_index_ = {x, y};
    last_tile_ = &tiles_[last_index_];
    changed_.insert(last_index_);
  }
  return (*last_tile_)[static_cast<std::size_t>(((j & kTileMask) << kTileShift) + (i & kTileMask))];
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
  last_tile_ = nullptr;  // so that every touched tile is noted as changed
  const Pose2 T_map_laser = T_map_base * sensor.T_base_laser;
  const PointMover to_map(T_map_laser);
  aim(scan);
  for (std::size_t k = 0; k < scan.ranges_m.size(); ++k) {
    const bool measured = is_return(scan.ranges_m[k], sensor);
    if (!measured && !(sensor.no_return_is_free && scan.ranges_m[k] >= sensor.range_max_m)) continue;
    const double range_m = measured ? static_cast<double>(scan.ranges_m[k]) : sensor.range_max_m;
    const double drawn_m = std::min(range_m, range_limit_m_);
    draw_beam(T_map_laser.translation(), to_map * (drawn_m * directions_[k]), measured && range_m <= range_limit_m_, sign);
  }
}

/// Visits every cell the segment crosses (Amanatides and Woo, Eurographics 1987).
void OccupancyMap::draw_beam(const Eigen::Vector2d& from, const Eigen::Vector2d& to, bool ends_there, int sign) {
  const Eigen::Vector2d a = from / resolution_m_, b = to / resolution_m_, d = b - a;
  int i = static_cast<int>(std::floor(a.x())), j = static_cast<int>(std::floor(a.y()));
  const int i_end = static_cast<int>(std::floor(b.x())), j_end = static_cast<int>(std::floor(b.y()));
  const int step_i = d.x() > 0 ? 1 : -1, step_j = d.y() > 0 ? 1 : -1;
  const double huge = 1e30;
  const double delta_i = d.x() != 0 ? std::abs(1 / d.x()) : huge, delta_j = d.y() != 0 ? std::abs(1 / d.y()) : huge;
  double next_i = d.x() != 0 ? (i + (step_i > 0) - a.x()) / d.x() : huge;
  double next_j = d.y() != 0 ? (j + (step_j > 0) - a.y()) / d.y() : huge;
  int left = std::abs(i_end - i) + std::abs(j_end - j);  // cells still to enter; exact even where rounding is not
  while (left > 0) {
    // Within a tile the cells are steps in memory.
    Cell* at = &cell(i, j);
    const int row = step_j * kTileCells;
    const int tile_i = i >> kTileShift, tile_j = j >> kTileShift;
    do {
      at->passed += sign;
      --left;
      if ((next_i < next_j || j == j_end) && i != i_end) {
        next_i += delta_i;
        i += step_i;
        at += step_i;
        if (i >> kTileShift != tile_i) break;
      } else {
        next_j += delta_j;
        j += step_j;
        at += row;
        if (j >> kTileShift != tile_j) break;
      }
    } while (left > 0);
  }
  Cell& last = cell(i_end, j_end);
  (ends_there ? last.ended : last.passed) += sign;
}

std::set<OccupancyMap::TileIndex> OccupancyMap::take_changed() {
  std::set<TileIndex> out;
  std::swap(out, changed_);
  last_tile_ = nullptr;
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
    const Cell& c = tile->second[k];
    if (c.ended > 0 || c.passed > 0) out[k] = 765 * c.ended + 1 >= 253 * c.passed ? 255 : 1;  // render() >= 128, without a division
  }
}

std::vector<std::uint8_t> OccupancyMap::render(const TileIndex& index) const {
  std::vector<std::uint8_t> out(kTileCells * kTileCells, 0);
  const auto tile = tiles_.find(index);
  if (tile == tiles_.end()) return out;
  // A beam that ends says more than one that passes: at grazing angles many pass the cells of a wall.
  constexpr double kEndedWeight = 3.0;
  for (std::size_t k = 0; k < out.size(); ++k) {
    const Cell& c = tile->second[k];
    if (c.ended <= 0 && c.passed <= 0) continue;
    const double p = (kEndedWeight * c.ended + 0.5) / (kEndedWeight * c.ended + c.passed + 1.0);
    out[k] = static_cast<std::uint8_t>(1.5 + 254 * std::min(1.0, std::max(0.0, p)));
  }
  return out;
}

}  // namespace modslam
