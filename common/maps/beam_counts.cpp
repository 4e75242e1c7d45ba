// SPDX-License-Identifier: BSD-3-Clause
#include "common/maps/beam_counts.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace modslam {
namespace {

constexpr int kSheetShift = 9, kSheetCells = 1 << kSheetShift;
constexpr int kStride = kSheetCells + 8;  // from row to row: a power of two would put the cells of a column into few sets of the cache
constexpr std::size_t kKept = 16;         // sheets kept from scan to scan, of half a megabyte each
constexpr int kLine = 32;                 // counts in a line of the cache
constexpr int kBlock = 8;                 // cells looked at together
static_assert(BeamCounts::kTileCells % kBlock == 0 && kSheetCells % BeamCounts::kTileCells == 0, "tiles are whole blocks, sheets whole tiles");

std::int64_t fixed_point(double cells) { return static_cast<std::int64_t>(cells * static_cast<double>(std::int64_t{1} << 32)); }

std::size_t place_in(int i, int j) { return static_cast<std::size_t>(j * kStride + i); }

/// Whether a beam passes any of the cells that begin here.
bool any_in(const std::uint16_t* block) {
  std::uint64_t bits[kBlock / 4];
  std::memcpy(bits, block, sizeof bits);
  return bits[0] | bits[1];
}

}  // namespace

void BeamCounts::draw(const Eigen::Vector2d& eye, const Beam* begin, const Beam* end) {
  eye_ = eye;
  eye_cell_ = low_ = high_ = {floor_of(eye.x()), floor_of(eye.y())};
  for (const Beam* beam = begin; beam != end; ++beam) {
    const Cell last = beam->end_cell();
    for (const int axis : {0, 1}) {
      low_[axis] = std::min(low_[axis], last[axis]);
      high_[axis] = std::max(high_[axis], last[axis]);
    }
  }
  used_ = last_ = 0;
  if (sheets_.size() > kKept) {
    sheets_.resize(kKept);
    sheets_.shrink_to_fit();
  }
  sheet_at(eye_cell_);
  const Cell from = begin_of(sheets_[0]), to = end_of(sheets_[0]);
  for (int j = from[1]; j < to[1]; ++j) {  // asked for together: one by one, as the beams need them, each would be waited for
    const std::uint16_t* row = sheets_[0].counts.data() + place_in(from[0] - sheets_[0].corner[0], j - sheets_[0].corner[1]);
    for (int i = 0; i < to[0] - from[0]; i += kLine) __builtin_prefetch(row + i, 1);
  }
  for (const Beam* beam = begin; beam != end; ++beam) add(*beam);
}

/// The first sheet has the eye's tile in its middle; the others lie side by side with it.
BeamCounts::Sheet& BeamCounts::sheet_at(const Cell& cell) {
  const auto holds = [&](const Sheet& sheet) {
    return static_cast<unsigned>(cell[0] - sheet.corner[0]) < kSheetCells && static_cast<unsigned>(cell[1] - sheet.corner[1]) < kSheetCells;
  };
  if (last_ < used_ && holds(sheets_[last_])) return sheets_[last_];
  const auto end = sheets_.begin() + static_cast<std::ptrdiff_t>(used_), found = std::find_if(sheets_.begin(), end, holds);
  last_ = static_cast<std::size_t>(found - sheets_.begin());
  if (found != end) return *found;
  if (used_ == sheets_.size()) sheets_.push_back({{}, std::vector<std::uint16_t>(static_cast<std::size_t>(kSheetCells * kStride), std::uint16_t{0})});
  for (const int axis : {0, 1}) {
    const int first = (eye_cell_[axis] & ~kTileMask) - kSheetCells / 2;
    sheets_[used_].corner[axis] = first + ((cell[axis] - first) & ~(kSheetCells - 1));
  }
  return sheets_[used_++];
}

/// Every cell but the first is entered over one of its sides, so the borders between columns and those between rows are gone through one after the other: no
/// step has to choose between them, and none waits for what the one before has written. (The cells are those of Amanatides and Woo, Eurographics 1987.)
void BeamCounts::add(const Beam& beam) {
  const Eigen::Vector2d way = beam.end - eye_;
  const Cell last = beam.end_cell();
  Cell borders = {std::abs(last[0] - eye_cell_[0]), std::abs(last[1] - eye_cell_[1])};
  if (beam.hits) {
    if (borders[0] + borders[1] == 0) return;
    const auto beyond = [&](int axis) { return way[axis] > 0 ? beam.end[axis] - last[axis] : last[axis] + 1 - beam.end[axis]; };  // the last border of the axis
    const bool x_is_last = borders[1] == 0 || (borders[0] > 0 && beyond(0) * std::abs(way.y()) <= beyond(1) * std::abs(way.x()));
    --borders[x_is_last ? 0 : 1];
  }
  Sheet& sheet = sheet_at(eye_cell_);
  ++sheet.counts[place_in(eye_cell_[0] - sheet.corner[0], eye_cell_[1] - sheet.corner[1])];
  for (const int axis : {0, 1})
    if (borders[axis] > 0) cross(axis, way, borders[axis]);
}

/// Counts the cells entered over the first borders across an axis.
void BeamCounts::cross(int axis, const Eigen::Vector2d& way, int borders) {
  const int step = way[axis] > 0 ? 1 : -1, other = 1 - axis;
  const std::ptrdiff_t u_stride = axis == 0 ? 1 : kStride, v_stride = axis == 0 ? kStride : 1;
  const double length = std::abs(way[axis]), to_border = step > 0 ? eye_cell_[axis] + 1 - eye_[axis] : eye_[axis] - eye_cell_[axis];
  std::int64_t level = fixed_point(eye_[other] + to_border / length * way[other]);  // place on the other axis
  const std::int64_t rise = borders > 1 ? fixed_point(way[other] / length) : 0;
  int u = eye_cell_[axis] + step;
  const int end = u + step * borders;
  while (u != end) {
    Cell here;
    here[axis] = u;
    here[other] = static_cast<int>(level >> 32);
    Sheet& sheet = sheet_at(here);
    const int u_begin = sheet.corner[axis], v_begin = sheet.corner[other];
    const int stop = step > 0 ? std::min(end, u_begin + kSheetCells) : std::max(end, u_begin - 1);
    std::uint16_t* line = sheet.counts.data() + (u - u_begin) * u_stride;
    for (; u != stop; u += step, line += step * u_stride, level += rise) {
      const int v = static_cast<int>(level >> 32) - v_begin;
      if (static_cast<unsigned>(v) >= kSheetCells) break;
      ++line[v * v_stride];
    }
  }
}

BeamCounts::Cell BeamCounts::begin_of(const Sheet& sheet) const {
  return {std::max(sheet.corner[0], low_[0] & ~kTileMask), std::max(sheet.corner[1], low_[1] & ~kTileMask)};
}

BeamCounts::Cell BeamCounts::end_of(const Sheet& sheet) const {
  return {std::min(sheet.corner[0] + kSheetCells, high_[0] + 1), std::min(sheet.corner[1] + kSheetCells, high_[1] + 1)};
}

std::vector<BeamCounts::TileIndex> BeamCounts::tiles() const {
  std::vector<TileIndex> out;
  for (std::size_t k = 0; k < used_; ++k) {
    const Sheet& sheet = sheets_[k];
    const auto passed = [&](int i, int j) {
      const std::uint16_t* row = sheet.counts.data() + place_in(i - sheet.corner[0], j - sheet.corner[1]);
      for (int y = 0; y < kTileCells; ++y, row += kStride)
        for (int x = 0; x < kTileCells; x += kBlock)
          if (any_in(row + x)) return true;
      return false;
    };
    const Cell begin = begin_of(sheet), end = end_of(sheet);
    for (int j = begin[1]; j < end[1]; j += kTileCells)
      for (int i = begin[0]; i < end[0]; i += kTileCells)
        if (passed(i, j)) out.emplace_back(i >> kTileShift, j >> kTileShift);
  }
  return out;
}

void BeamCounts::pour(const TileIndex& tile, int sign, std::int32_t* numbers) {
  const Cell corner = {tile.first * kTileCells, tile.second * kTileCells};
  Sheet& sheet = sheet_at(corner);
  std::uint16_t* row = sheet.counts.data() + place_in(corner[0] - sheet.corner[0], corner[1] - sheet.corner[1]);
  for (int y = 0; y < kTileCells; ++y, row += kStride, numbers += kTileCells)
    for (int x = 0; x < kTileCells; x += kBlock) {
      if (!any_in(row + x)) continue;
      for (int k = x; k < x + kBlock; ++k) numbers[k] += sign * row[k];
      std::fill(row + x, row + x + kBlock, std::uint16_t{0});
    }
}

}  // namespace modslam
