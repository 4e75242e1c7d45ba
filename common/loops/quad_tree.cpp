// SPDX-License-Identifier: BSD-3-Clause
#include "common/loops/quad_tree.hpp"

namespace modslam {
namespace {

constexpr std::size_t kLeafSize = 8;
constexpr double kSmallestHalf_m = 0.05;  // a leaf this small keeps whatever comes
constexpr double kFirstHalf_m = 16.0;

int quadrant(const Eigen::Vector2d& centre, const Eigen::Vector2d& p) {
  return (p.x() >= centre.x() ? 1 : 0) + (p.y() >= centre.y() ? 2 : 0);
}

Eigen::Vector2d child_centre(const Eigen::Vector2d& centre, double half_m, int quadrant) {
  return centre + 0.5 * half_m * Eigen::Vector2d(quadrant & 1 ? 1 : -1, quadrant & 2 ? 1 : -1);
}

}  // namespace

void QuadTree::insert(const Eigen::Vector2d& p, std::int64_t id) {
  if (!root_) root_.reset(new Cell{p, kFirstHalf_m, {}, {}});
  while (!root_->contains(p)) {
    // The old root becomes a quarter of one twice as large, on the side of the point.
    const Eigen::Vector2d towards(p.x() >= root_->centre.x() ? 1 : -1, p.y() >= root_->centre.y() ? 1 : -1);
    const double half_m = root_->half_m;
    std::unique_ptr<Cell> grown(new Cell{root_->centre + half_m * towards, 2 * half_m, {}, {}});
    for (int q = 0; q < 4; ++q)
      grown->children[q].reset(new Cell{child_centre(grown->centre, 2 * half_m, q), half_m, {}, {}});
    const int old = quadrant(grown->centre, root_->centre);
    grown->children[old] = std::move(root_);
    root_ = std::move(grown);
  }
  insert(*root_, {p, id});
  ++size_;
}

void QuadTree::insert(Cell& cell, const Entry& entry) {
  if (cell.children[0]) return insert(*cell.children[quadrant(cell.centre, entry.p)], entry);
  cell.entries.push_back(entry);
  if (cell.entries.size() <= kLeafSize || cell.half_m <= kSmallestHalf_m) return;
  for (int q = 0; q < 4; ++q)
    cell.children[q].reset(new Cell{child_centre(cell.centre, cell.half_m, q), cell.half_m / 2, {}, {}});
  for (const Entry& moved : cell.entries) insert(*cell.children[quadrant(cell.centre, moved.p)], moved);
  cell.entries.clear();
}

std::vector<QuadTree::Entry> QuadTree::near(const Eigen::Vector2d& p, double radius_m) const {
  std::vector<Entry> out;
  if (root_) collect(*root_, p, radius_m, out);
  return out;
}

void QuadTree::collect(const Cell& cell, const Eigen::Vector2d& p, double radius_m, std::vector<Entry>& out) {
  const Eigen::Vector2d outside = ((p - cell.centre).cwiseAbs() - Eigen::Vector2d::Constant(cell.half_m)).cwiseMax(0.0);
  if (outside.squaredNorm() > radius_m * radius_m) return;
  for (const Entry& entry : cell.entries)
    if ((entry.p - p).squaredNorm() <= radius_m * radius_m) out.push_back(entry);
  if (cell.children[0])
    for (const auto& child : cell.children) collect(*child, p, radius_m, out);
}

}  // namespace modslam
