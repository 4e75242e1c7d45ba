// SPDX-License-Identifier: BSD-3-Clause
#include "common/matching/score_grid.hpp"

#include <algorithm>
#include <cmath>
#include <queue>

namespace modslam {
namespace {

constexpr int kShifts[] = {0, 2, 4};
constexpr int kMargin = 40;        // free cells kept around the walls
constexpr int kMaxSide = 2400;     // cells; farther points are left out

struct Cell {
  int x, y;
};

/// One block of poses: translations [i, i + 2^shift) x [j, j + 2^shift) at one heading.
struct Block {
  int bound;  ///< sum over the points, never less than any pose inside
  int level, angle, i, j;
  bool operator<(const Block& other) const {  // greatest bound first; then a fixed order, for repeatability
    if (bound != other.bound) return bound < other.bound;
    if (level != other.level) return level > other.level;
    if (angle != other.angle) return angle > other.angle;
    if (i != other.i) return i > other.i;
    return j > other.j;
  }
};

}  // namespace

void ScoreGrid::build(const std::vector<Eigen::Vector2d>& walls, double blur_m) {
  levels_.resize(std::size(kShifts));
  Level& fine = levels_[0];
  if (walls.empty()) {
    for (Level& level : levels_) level.width = level.height = 0;
    return;
  }
  Eigen::Vector2d low = walls[0], high = walls[0];
  for (const Eigen::Vector2d& p : walls) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const auto cells = [&](double metres) {
    return std::min(kMaxSide, static_cast<int>(metres / resolution_m_) + 2 * kMargin + 1);
  };
  origin_ = low - Eigen::Vector2d::Constant(kMargin * resolution_m_);
  fine.width = cells(high.x() - low.x());
  fine.height = cells(high.y() - low.y());
  fine.values.assign(static_cast<std::size_t>(fine.width) * static_cast<std::size_t>(fine.height), 0);

  const int reach = static_cast<int>(std::ceil(2.5 * blur_m / resolution_m_));
  const int side = 2 * reach + 1;
  std::vector<std::uint8_t> kernel(static_cast<std::size_t>(side * side));
  for (int y = -reach; y <= reach; ++y)
    for (int x = -reach; x <= reach; ++x) {
      const double d = std::hypot(x, y) * resolution_m_ / blur_m;
      kernel[static_cast<std::size_t>((y + reach) * side + x + reach)] =
          static_cast<std::uint8_t>(std::lround(255 * std::exp(-0.5 * d * d)));
    }
  for (const Eigen::Vector2d& p : walls) {
    const int cx = static_cast<int>((p.x() - origin_.x()) / resolution_m_);
    const int cy = static_cast<int>((p.y() - origin_.y()) / resolution_m_);
    if (cx < reach || cy < reach || cx + reach >= fine.width || cy + reach >= fine.height) continue;
    if (fine.at(cx, cy) == 255) continue;
    for (int y = 0; y < side; ++y) {
      std::uint8_t* row = &fine.values[static_cast<std::size_t>(cy + y - reach) * static_cast<std::size_t>(fine.width) +
                                       static_cast<std::size_t>(cx - reach)];
      const std::uint8_t* from = &kernel[static_cast<std::size_t>(y * side)];
      for (int x = 0; x < side; ++x) row[x] = std::max(row[x], from[x]);
    }
  }
  for (std::size_t k = 1; k < levels_.size(); ++k) {
    levels_[k].shift = kShifts[k];
    build_coarse(levels_[k - 1], levels_[k]);
  }
}

/// coarse(X) = max of the fine level over the block of X and the blocks after it in x and y: 2 x 2 blocks.
void ScoreGrid::build_coarse(const Level& fine, Level& coarse) const {
  const int factor = 1 << (coarse.shift - fine.shift);
  coarse.width = (fine.width + factor - 1) / factor;
  coarse.height = (fine.height + factor - 1) / factor;
  const auto width = static_cast<std::size_t>(coarse.width), height = static_cast<std::size_t>(coarse.height);
  std::vector<std::uint8_t> block(width * height, 0);
  for (int y = 0; y < fine.height; ++y) {
    const std::uint8_t* from = &fine.values[static_cast<std::size_t>(y) * static_cast<std::size_t>(fine.width)];
    std::uint8_t* to = &block[static_cast<std::size_t>(y / factor) * width];
    for (int x = 0; x < fine.width; ++x) to[x / factor] = std::max(to[x / factor], from[x]);
  }
  // The level below already reaches one of its own blocks too far; that only loosens the bound.
  coarse.values.assign(width * height, 0);
  for (std::size_t y = 0; y < height; ++y)
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t right = std::min(x + 1, width - 1), up = std::min(y + 1, height - 1);
      coarse.values[y * width + x] = std::max(std::max(block[y * width + x], block[y * width + right]),
                                              std::max(block[up * width + x], block[up * width + right]));
    }
}

double ScoreGrid::score(const std::vector<Eigen::Vector2d>& points_base, const Pose2& T_map_base) const {
  if (empty() || points_base.empty()) return 0;
  int sum = 0;
  for (const Eigen::Vector2d& p : points_base) {
    const Eigen::Vector2d q = (T_map_base * p - origin_) / resolution_m_;
    sum += levels_[0].at(static_cast<int>(std::floor(q.x())), static_cast<int>(std::floor(q.y())));
  }
  return sum / (255.0 * static_cast<double>(points_base.size()));
}

SearchResult ScoreGrid::search(const std::vector<Eigen::Vector2d>& points_base, const Pose2& guess,
                               const SearchWindow& window, bool find_second, double apart_m,
                               double apart_rad) const {
  SearchResult result;
  result.T_map_base = guess;
  if (empty() || points_base.empty()) return result;

  // A step of the heading moves the farthest of most points by about a cell.
  std::vector<double> reach;
  for (const Eigen::Vector2d& p : points_base) reach.push_back(p.norm());
  std::nth_element(reach.begin(), reach.begin() + static_cast<std::ptrdiff_t>(reach.size() * 8 / 10), reach.end());
  const double far_m = std::clamp(reach[reach.size() * 8 / 10], 2.0, 15.0);
  const double step_rad = resolution_m_ / far_m;
  const int half_angles = static_cast<int>(std::ceil(window.half_rad / step_rad));
  const int half_cells = static_cast<int>(std::ceil(window.half_m / resolution_m_));
  const int n_points = static_cast<int>(points_base.size());

  std::vector<std::vector<Cell>> cells(static_cast<std::size_t>(2 * half_angles + 1));
  for (int a = -half_angles; a <= half_angles; ++a) {
    const Pose2 turned(guess.x, guess.y, guess.heading + a * step_rad);
    auto& list = cells[static_cast<std::size_t>(a + half_angles)];
    list.reserve(points_base.size());
    for (const Eigen::Vector2d& p : points_base) {
      const Eigen::Vector2d q = (turned * p - origin_) / resolution_m_;
      list.push_back({static_cast<int>(std::floor(q.x())), static_cast<int>(std::floor(q.y()))});
    }
  }
  const auto penalty = [&](int angle, int i, int j) {
    if (window.prior_weight <= 0) return 0;
    const double dm = std::hypot(i, j) * resolution_m_ / window.prior_sigma_m;
    const double da = (angle - half_angles) * step_rad / window.prior_sigma_rad;
    return static_cast<int>(std::lround(window.prior_weight * 255 * n_points * (dm * dm + da * da)));
  };
  const auto bound = [&](int level_index, int angle, int i, int j) {
    const Level& level = levels_[static_cast<std::size_t>(level_index)];
    int sum = 0;
    for (const Cell& c : cells[static_cast<std::size_t>(angle)])
      sum += level.at((c.x + i) >> level.shift, (c.y + j) >> level.shift);
    if (level_index == 0) sum -= penalty(angle, i, j);
    return sum;
  };

  const int top = half_cells > 24 ? 2 : half_cells > 2 ? 1 : 0;
  std::priority_queue<Block> open;
  const int stride = 1 << kShifts[top];
  for (int angle = 0; angle <= 2 * half_angles; ++angle)
    for (int i = -half_cells; i <= half_cells; i += stride)
      for (int j = -half_cells; j <= half_cells; j += stride)
        open.push({bound(top, angle, i, j), top, angle, i, j});

  bool found = false;
  Block best{};
  while (!open.empty()) {
    const Block block = open.top();
    open.pop();
    const auto apart = [&](int i, int j) {
      return std::hypot(i - best.i, j - best.j) * resolution_m_ > apart_m ||
             std::abs(block.angle - best.angle) * step_rad > apart_rad;
    };
    if (block.level > 0) {
      const int last = (1 << kShifts[block.level]) - 1;
      if (found && !apart(block.i, block.j) && !apart(block.i + last, block.j) &&
          !apart(block.i, block.j + last) && !apart(block.i + last, block.j + last))
        continue;  // all of it is the winner's own surroundings
      const int child = block.level - 1, step = 1 << kShifts[child], end = 1 << kShifts[block.level];
      for (int i = block.i; i < block.i + end && i <= half_cells; i += step)
        for (int j = block.j; j < block.j + end && j <= half_cells; j += step) {
          const int value = bound(child, block.angle, i, j);
          open.push({value, child, block.angle, i, j});
        }
      continue;
    }
    const auto to_score = [&](const Block& leaf) {
      return (leaf.bound + penalty(leaf.angle, leaf.i, leaf.j)) / (255.0 * n_points);
    };
    if (!found) {
      found = true;
      best = block;
      result.T_map_base = {guess.x + block.i * resolution_m_, guess.y + block.j * resolution_m_,
                           wrap_angle(guess.heading + (block.angle - half_angles) * step_rad)};
      result.score = to_score(block);
      result.at_border = std::abs(block.i) == half_cells || std::abs(block.j) == half_cells ||
                         std::abs(block.angle - half_angles) == half_angles;
      if (!find_second) break;
    } else if (apart(block.i, block.j)) {
      result.second_score = to_score(block);
      break;
    } else if (block.bound < best.bound * 3 / 4) {
      break;  // nothing left that could be called a rival
    }
  }
  return result;
}

}  // namespace modslam
