// SPDX-License-Identifier: BSD-3-Clause
#include "common/matching/score_grid.hpp"

#include <algorithm>
#include <cmath>
#include <queue>

namespace modslam {
namespace {

constexpr int kLevels = 6;         // level k: blocks of 2^k cells
constexpr double kApart_m = 0.5, kApart_rad = 0.3;  // from here on a pose is another place than the winner's
constexpr std::size_t kChunk = 16;   // points summed between two looks at whether it is worth it
constexpr int kHopeless = -1'000'000'000;
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

/// The coarsest level with which a window of this many cells to each side is searched.
int top_level(int half_cells) {
  int level = 0;
  while (level + 1 < kLevels && (1 << (level + 1)) <= half_cells / 2) ++level;
  return level;
}

}  // namespace

void ScoreGrid::build(const std::vector<Eigen::Vector2d>& walls, double blur_m, double widest_m) {
  levels_.resize(kLevels);
  levels_ready_ = static_cast<std::size_t>(top_level(static_cast<int>(std::ceil(widest_m / resolution_m_)))) + 1;
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
  Level blocks = fine;
  for (std::size_t k = 1; k < levels_ready_; ++k) {
    blocks = halve(blocks);
    levels_[k] = with_neighbours(blocks);
  }
}

/// Each cell the largest of 2 x 2.
ScoreGrid::Level ScoreGrid::halve(const Level& fine) {
  Level coarse;
  coarse.shift = fine.shift + 1;
  coarse.width = (fine.width + 1) / 2;
  coarse.height = (fine.height + 1) / 2;
  const auto width = static_cast<std::size_t>(fine.width), height = static_cast<std::size_t>(fine.height);
  coarse.values.resize(static_cast<std::size_t>(coarse.width) * static_cast<std::size_t>(coarse.height));
  std::vector<std::uint8_t> rows(width + 1, 0);  // the larger of two rows; one more column where the width is odd
  std::uint8_t* to = coarse.values.data();
  for (std::size_t y = 0; y < height; y += 2, to += coarse.width) {
    const std::uint8_t *low = &fine.values[y * width], *high = y + 1 < height ? low + width : low;
    for (std::size_t x = 0; x < width; ++x) rows[x] = std::max(low[x], high[x]);
    for (std::size_t x = 0; x < static_cast<std::size_t>(coarse.width); ++x) to[x] = std::max(rows[2 * x], rows[2 * x + 1]);
  }
  return coarse;
}

/// Each block the largest of itself and the blocks after it in x and y: wherever in a block a point lies, all poses of a block of
/// translations keep it inside.
ScoreGrid::Level ScoreGrid::with_neighbours(const Level& blocks) {
  Level out = blocks;
  const auto width = static_cast<std::size_t>(blocks.width), height = static_cast<std::size_t>(blocks.height);
  std::vector<std::uint8_t> rows(width + 1, 0);
  for (std::size_t y = 0; y < height; ++y) {
    const std::uint8_t *low = &blocks.values[y * width], *high = y + 1 < height ? low + width : low;
    for (std::size_t x = 0; x < width; ++x) rows[x] = std::max(low[x], high[x]);
    for (std::size_t x = 0; x < width; ++x) out.values[y * width + x] = std::max(rows[x], rows[x + 1]);
  }
  return out;
}

double ScoreGrid::score(const std::vector<Eigen::Vector2d>& points_base, const Pose2& T_map_base) const {
  if (empty() || points_base.empty()) return 0;
  int sum = 0;
  const PointMover to_map(T_map_base);
  for (const Eigen::Vector2d& p : points_base) {
    const Eigen::Vector2d q = (to_map * p - origin_) / resolution_m_;
    sum += levels_[0].at(static_cast<int>(std::floor(q.x())), static_cast<int>(std::floor(q.y())));
  }
  return sum / (255.0 * static_cast<double>(points_base.size()));
}

SearchResult ScoreGrid::search(const std::vector<Eigen::Vector2d>& points_base, const Pose2& guess,
                               const SearchWindow& window, double rival_share) const {
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
    const PointMover turned(Pose2(guess.x, guess.y, guess.heading + a * step_rad));
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
  // What is surely worse than the guess itself (or than its rivals may be) is not looked at further.
  const double share = rival_share > 0 ? rival_share : 1.0;
  int least = static_cast<int>(share * 255 * n_points * score(points_base, guess));
  const auto bound = [&](int level_index, int angle, int i, int j) {
    const Level& level = levels_[static_cast<std::size_t>(level_index)];
    const std::vector<Cell>& list = cells[static_cast<std::size_t>(angle)];
    int sum = level_index == 0 ? -penalty(angle, i, j) : 0;
    for (std::size_t k = 0; k < list.size();) {
      if (sum + 255 * static_cast<int>(list.size() - k) < least) return kHopeless;
      for (const std::size_t end = std::min(list.size(), k + kChunk); k < end; ++k)
        sum += level.at((list[k].x + i) >> level.shift, (list[k].y + j) >> level.shift);
    }
    return sum;
  };
  std::priority_queue<Block> open;
  const auto push = [&](int level, int angle, int i, int j) {
    const int value = bound(level, angle, i, j);
    if (value >= least) open.push({value, level, angle, i, j});
  };

  const int top = std::min(top_level(half_cells), static_cast<int>(levels_ready_) - 1);
  const int stride = 1 << top;
  for (int angle = 0; angle <= 2 * half_angles; ++angle)
    for (int i = -half_cells; i <= half_cells; i += stride)
      for (int j = -half_cells; j <= half_cells; j += stride)
        push(top, angle, i, j);

  bool found = false;
  Block best{};
  result.second_score = std::max(0, least) / (255.0 * n_points);  // where nothing comes near
  const double apart_cells2 = (kApart_m / resolution_m_) * (kApart_m / resolution_m_);
  while (!open.empty()) {
    const Block block = open.top();
    open.pop();
    if (found && block.bound < rival_share * best.bound) {
      result.second_score = std::max(0, block.bound) / (255.0 * n_points);
      break;  // nothing left that could be called a rival
    }
    const auto apart = [&](int i, int j) {
      return (i - best.i) * (i - best.i) + (j - best.j) * (j - best.j) > apart_cells2 ||
             std::abs(block.angle - best.angle) * step_rad > kApart_rad;
    };
    if (block.level > 0) {
      const int last = (1 << block.level) - 1;
      if (found && !apart(block.i, block.j) && !apart(block.i + last, block.j) &&
          !apart(block.i, block.j + last) && !apart(block.i + last, block.j + last))
        continue;  // all of it is the winner's own surroundings
      const int child = block.level - 1, step = 1 << child, end = 1 << block.level;
      for (int i = block.i; i < block.i + end && i <= half_cells; i += step)
        for (int j = block.j; j < block.j + end && j <= half_cells; j += step)
          push(child, block.angle, i, j);
      continue;
    }
    const auto to_score = [&](const Block& leaf) {
      return (leaf.bound + penalty(leaf.angle, leaf.i, leaf.j)) / (255.0 * n_points);
    };
    if (!found) {
      found = true;
      best = block;
      least = static_cast<int>(share * best.bound);
      result.second_score = std::max(0, least) / (255.0 * n_points);
      result.T_map_base = {guess.x + block.i * resolution_m_, guess.y + block.j * resolution_m_,
                           wrap_angle(guess.heading + (block.angle - half_angles) * step_rad)};
      result.score = to_score(block);
      result.at_border = std::abs(block.i) == half_cells || std::abs(block.j) == half_cells ||
                         std::abs(block.angle - half_angles) == half_angles;
      if (rival_share <= 0) break;
    } else if (apart(block.i, block.j)) {
      result.second_score = to_score(block);
      break;
    }
  }
  return result;
}

}  // namespace modslam
