// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/wall_blocks.hpp"

#include <algorithm>
#include <cmath>

namespace modslam {
namespace {

constexpr int kDirections = 180;
constexpr double kApart_m = 0.05;
constexpr double kShortest_m = 1e-6, kLongest_m = 1e3, kFarthest_m = 1e6;

int block_of(double x_m) { return static_cast<int>(std::floor(x_m / WallBlocks::kBlock_m)); }

/// Where along a segment (0..1) a coordinate crosses borders of blocks.
void add_crossings(double from, double to, std::vector<double>& at) {
  const int first = block_of(std::min(from, to)) + 1, last = block_of(std::max(from, to));
  for (int k = first; k <= last; ++k) at.push_back(std::clamp((k * WallBlocks::kBlock_m - from) / (to - from), 0.0, 1.0));
}

std::int64_t fixed(double value, double unit) { return std::llround(value / unit); }

}  // namespace

Eigen::Vector2d WallBlocks::direction(const LineKey& key) {
  const double angle = (key.first + 0.5) * 2 * kPi / kDirections;
  return {std::cos(angle), std::sin(angle)};
}

void WallBlocks::add(const Segment& segment, int sign) {
  const double length_m = segment.length_m();
  if (!(length_m > kShortest_m && length_m < kLongest_m) || !(segment.a.cwiseAbs().maxCoeff() < kFarthest_m) || !(segment.b.cwiseAbs().maxCoeff() < kFarthest_m)) return;
  std::vector<double> at{0, 1};
  for (int axis = 0; axis < 2; ++axis) add_crossings(segment.a[axis], segment.b[axis], at);
  std::sort(at.begin(), at.end());
  for (std::size_t k = 0; k + 1 < at.size(); ++k) {
    if ((at[k + 1] - at[k]) * length_m < kShortest_m) continue;
    Segment piece = segment;
    piece.a = segment.a + at[k] * (segment.b - segment.a);
    piece.b = segment.a + at[k + 1] * (segment.b - segment.a);
    add_piece(piece, segment.points * (at[k + 1] - at[k]), sign);
  }
}

void WallBlocks::add_piece(const Segment& piece, double points, int sign) {
  const Eigen::Vector2d mid = 0.5 * (piece.a + piece.b);
  const Index index(block_of(mid.x()), block_of(mid.y()));
  const Eigen::Vector2d c = centre(index), u = (piece.b - piece.a).normalized(), m = mid - c, half = 0.5 * (piece.b - piece.a);
  const double angle = std::atan2(u.y(), u.x());
  LineKey key(std::clamp(static_cast<int>((angle < 0 ? angle + 2 * kPi : angle) / (2 * kPi) * kDirections), 0, kDirections - 1), 0);
  const Eigen::Vector2d d = direction(key);
  key.second = static_cast<int>(std::floor((d.x() * m.y() - d.y() * m.x()) / kApart_m));

  LineSums& sums = blocks_[index][key];
  const double s2 = 0.5 * piece.sigma_m * piece.sigma_m;
  const auto put = [&](std::int64_t& sum, double value, double unit) { sum += sign * fixed(points * value, unit * kPointUnit); };
  put(sums.n, 1, 1);
  put(sums.x, m.x(), kLengthUnit);
  put(sums.y, m.y(), kLengthUnit);
  put(sums.xx, m.x() * m.x() + half.x() * half.x() / 3 + s2, kLengthUnit * kLengthUnit);
  put(sums.xy, m.x() * m.y() + half.x() * half.y() / 3, kLengthUnit * kLengthUnit);
  put(sums.yy, m.y() * m.y() + half.y() * half.y() / 3 + s2, kLengthUnit * kLengthUnit);
  put(sums.ux, u.x(), kLengthUnit);
  put(sums.uy, u.y(), kLengthUnit);
  const auto bin = [&](const Eigen::Vector2d& p) {
    return std::clamp(static_cast<int>(std::floor(d.dot(p - c) / LineSums::kBin_m)) + LineSums::kBins / 2, 0, LineSums::kBins - 1);
  };
  for (int k = bin(piece.a), last = bin(piece.b); k <= last; ++k) sums.sightings[static_cast<std::size_t>(k)] += sign;
  if (sums.n == 0 && std::all_of(sums.sightings.begin(), sums.sightings.end(), [](int count) { return count == 0; })) blocks_[index].erase(key);
  changed_.insert(index);
}

std::set<WallBlocks::Index> WallBlocks::take_changed() {
  std::set<Index> out;
  std::swap(out, changed_);
  return out;
}

}  // namespace modslam
