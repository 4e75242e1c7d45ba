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
  forget_near();
}

inline OccupancyMap::Cell& OccupancyMap::cell(int i, int j) {
  const TileIndex index(i >> kTileShift, j >> kTileShift);  // rounds down, for negative cells too
  Near& near = near_[static_cast<std::size_t>((index.first & (kNear - 1)) + kNear * (index.second & (kNear - 1)))];
  if (!near.tile || near.index != index) {
    near = {index, &tiles_[index]};
    changed_.insert(index);
  }
  return (*near.tile)[static_cast<std::size_t>(((j & kTileMask) << kTileShift) + (i & kTileMask))];
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
  forget_near();  // so that every touched tile is noted as changed
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

/// Visits every cell the segment crosses (Amanatides and Woo, Eurographics 1987). Which border comes next is the sign of one fixed-point number, so that
/// no step waits for a branch that is as good as random.
void OccupancyMap::draw_beam(const Eigen::Vector2d& from, const Eigen::Vector2d& to, bool ends_there, int sign) {
  constexpr double kFarthest = 256;  // beam lengths: a border that far is never met
  const auto fixed = [&](double share) { return static_cast<std::int64_t>(std::min(share, kFarthest) * static_cast<double>(std::int64_t{1} << 52)); };
  const Eigen::Vector2d a = from / resolution_m_, b = to / resolution_m_, d = b - a;
  int i = static_cast<int>(std::floor(a.x())), j = static_cast<int>(std::floor(a.y()));
  const int i_end = static_cast<int>(std::floor(b.x())), j_end = static_cast<int>(std::floor(b.y()));
  const int step_i = d.x() > 0 ? 1 : -1, step_j = d.y() > 0 ? 1 : -1;
  const std::int64_t delta_i = fixed(d.x() != 0 ? std::abs(1 / d.x()) : kFarthest), delta_j = fixed(d.y() != 0 ? std::abs(1 / d.y()) : kFarthest);
  std::int64_t lead = fixed(d.x() != 0 ? (i + (step_i > 0) - a.x()) / d.x() : kFarthest) - fixed(d.y() != 0 ? (j + (step_j > 0) - a.y()) / d.y() : kFarthest);
  int left = std::abs(i_end - i) + std::abs(j_end - j);  // cells still to enter; exact even where rounding is not
  // Both places within a tile as one number: bit 6 of each byte is set as long as they are in the tile.
  constexpr std::uint32_t kInside = 0x4040, kByte = 0xff;
  const auto along_i = static_cast<std::uint32_t>(step_i), along_j = static_cast<std::uint32_t>(step_j * 256);
  const std::ptrdiff_t row = step_j * kTileCells, aside = step_i - row;
  while (left > 0) {
    Cell* at = &cell(i, j);
    const auto x = static_cast<std::uint32_t>(i & kTileMask), y = static_cast<std::uint32_t>(j & kTileMask);
    std::uint32_t place = (x + kTileCells) | (y + kTileCells) << 8;
    do {
      at->passed += sign;
      --left;
      const std::int64_t i_is_next = lead >> 63;  // all bits or none
      lead += (i_is_next & (delta_i + delta_j)) - delta_j;
      at += row + (i_is_next & aside);
      place += along_j + (static_cast<std::uint32_t>(i_is_next) & (along_i - along_j));
    } while (left > 0 && (place & kInside) == kInside);
    i += static_cast<int>(place & kByte) - kTileCells - static_cast<int>(x);
    j += static_cast<int>(place >> 8 & kByte) - kTileCells - static_cast<int>(y);
  }
  Cell& last = cell(i_end, j_end);
  (ends_there ? last.ended : last.passed) += sign;
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
