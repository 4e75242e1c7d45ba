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

/// Best-first search over the poses of a window.
class ScoreGrid::Search {
 public:
  /// @param least blocks that cannot reach it are not looked at further.
  Search(const ScoreGrid& grid, const std::vector<Eigen::Vector2d>& points_base, const Pose2& guess, const SearchWindow& window, int least)
      : grid_(grid), guess_(guess), window_(window), n_points_(static_cast<int>(points_base.size())), least_(least) {
    half_cells_ = static_cast<int>(std::ceil(window.half_m / grid.resolution_m_));
    turn(points_base);
    const int top = std::min(top_level(half_cells_), static_cast<int>(grid.levels_ready_) - 1), stride = 1 << top;
    for (int angle = 0; angle <= 2 * half_angles_; ++angle)
      for (int i = -half_cells_; i <= half_cells_; i += stride)
        for (int j = -half_cells_; j <= half_cells_; j += stride) push(top, angle, i, j);
  }

  /// The best pose that is well away from all `known` ones. @return false when none reaches what was asked for.
  bool next(const std::vector<Block>& known, Block& leaf) {
    while (!open_.empty()) {
      const Block block = open_.top();
      open_.pop();
      if (block.bound < least_) return false;
      if (is_near(block, known)) continue;
      if (block.level == 0) {
        leaf = block;
        return true;
      }
      const int child = block.level - 1, step = 1 << child, end = 1 << block.level;
      for (int i = block.i; i < block.i + end && i <= half_cells_; i += step)
        for (int j = block.j; j < block.j + end && j <= half_cells_; j += step) push(child, block.angle, i, j);
    }
    return false;
  }

  void raise(double share, const Block& best) { least_ = static_cast<int>(share * best.bound); }
  double to_score(int sum) const { return std::max(0, sum) / (255.0 * n_points_); }
  double least() const { return to_score(least_); }

  SearchResult result(const Block& leaf) const {
    SearchResult result;
    result.T_map_base = {guess_.x + leaf.i * grid_.resolution_m_, guess_.y + leaf.j * grid_.resolution_m_,
                         wrap_angle(guess_.heading + (leaf.angle - half_angles_) * step_rad_)};
    result.score = to_score(leaf.bound + penalty(leaf.angle, leaf.i, leaf.j));
    result.at_border = std::abs(leaf.i) == half_cells_ || std::abs(leaf.j) == half_cells_ || std::abs(leaf.angle - half_angles_) == half_angles_;
    return result;
  }

 private:
  /// The points as cells, for every heading. A step of the heading moves the farthest of most points by about a cell.
  void turn(const std::vector<Eigen::Vector2d>& points_base) {
    std::vector<double> reach;
    for (const Eigen::Vector2d& p : points_base) reach.push_back(p.norm());
    std::nth_element(reach.begin(), reach.begin() + static_cast<std::ptrdiff_t>(reach.size() * 8 / 10), reach.end());
    step_rad_ = grid_.resolution_m_ / std::clamp(reach[reach.size() * 8 / 10], 2.0, 15.0);
    half_angles_ = static_cast<int>(std::ceil(window_.half_rad / step_rad_));
    cells_.resize(static_cast<std::size_t>(2 * half_angles_ + 1));
    for (int a = -half_angles_; a <= half_angles_; ++a) {
      const PointMover turned(Pose2(guess_.x, guess_.y, guess_.heading + a * step_rad_));
      auto& list = cells_[static_cast<std::size_t>(a + half_angles_)];
      list.reserve(points_base.size());
      for (const Eigen::Vector2d& p : points_base) {
        const Eigen::Vector2d q = (turned * p - grid_.origin_) / grid_.resolution_m_;
        list.push_back({static_cast<int>(std::floor(q.x())), static_cast<int>(std::floor(q.y()))});
      }
    }
  }

  int penalty(int angle, int i, int j) const {
    if (window_.prior_weight <= 0) return 0;
    const double dm = std::hypot(i, j) * grid_.resolution_m_ / window_.prior_sigma_m;
    const double da = (angle - half_angles_) * step_rad_ / window_.prior_sigma_rad;
    return static_cast<int>(std::lround(window_.prior_weight * 255 * n_points_ * (dm * dm + da * da)));
  }

  /// Sum over the points, or kHopeless as soon as it cannot reach what was asked for.
  int bound(int level_index, int angle, int i, int j) const {
    const Level& level = grid_.levels_[static_cast<std::size_t>(level_index)];
    const std::vector<Cell>& list = cells_[static_cast<std::size_t>(angle)];
    int sum = level_index == 0 ? -penalty(angle, i, j) : 0;
    for (std::size_t k = 0; k < list.size();) {
      if (sum + 255 * static_cast<int>(list.size() - k) < least_) return kHopeless;
      for (const std::size_t end = std::min(list.size(), k + kChunk); k < end; ++k)
        sum += level.at((list[k].x + i) >> level.shift, (list[k].y + j) >> level.shift);
    }
    return sum;
  }

  void push(int level, int angle, int i, int j) {
    const int value = bound(level, angle, i, j);
    if (value >= least_) open_.push({value, level, angle, i, j});
  }

  /// Whether all of the block lies around a known pose.
  bool is_near(const Block& block, const std::vector<Block>& known) const {
    const int last = (1 << block.level) - 1;
    const double apart_cells = kApart_m / grid_.resolution_m_;
    return std::any_of(known.begin(), known.end(), [&](const Block& pose) {
      if (std::abs(std::remainder((block.angle - pose.angle) * step_rad_, 2 * kPi)) > kApart_rad) return false;
      const int di = std::max(std::abs(block.i - pose.i), std::abs(block.i + last - pose.i));
      const int dj = std::max(std::abs(block.j - pose.j), std::abs(block.j + last - pose.j));
      return di * di + dj * dj <= apart_cells * apart_cells;
    });
  }

  const ScoreGrid& grid_;
  Pose2 guess_;
  SearchWindow window_;
  int n_points_, least_, half_cells_ = 0, half_angles_ = 0;
  double step_rad_ = 0;
  std::vector<std::vector<Cell>> cells_;
  std::priority_queue<Block> open_;
};

SearchResult ScoreGrid::search(const std::vector<Eigen::Vector2d>& points_base, const Pose2& guess,
                               const SearchWindow& window, double rival_share) const {
  SearchResult result;
  result.T_map_base = guess;
  if (empty() || points_base.empty()) return result;
  // Worse than the guess itself (or than its rivals may be) is of no interest.
  const double share = rival_share > 0 ? rival_share : 1.0;
  Search search(*this, points_base, guess, window,
                static_cast<int>(share * 255 * static_cast<double>(points_base.size()) * score(points_base, guess)));
  Block best{}, rival{};
  if (!search.next({}, best)) return result;
  result = search.result(best);
  if (rival_share <= 0) return result;
  search.raise(rival_share, best);
  result.second_score = search.next({best}, rival) ? search.result(rival).score : search.least();
  return result;
}

}  // namespace modslam
