// SPDX-License-Identifier: BSD-3-Clause
/// @file A quad tree of points with ids, for "which old nodes are near?" (thesis, algorithm 3).
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

namespace modslam {

class QuadTree {
 public:
  struct Entry {
    Eigen::Vector2d p;
    std::int64_t id;
  };
  /// Grows by itself when a point lies outside.
  void insert(const Eigen::Vector2d& p, std::int64_t id);
  /// Entries within radius_m of p, in no particular but repeatable order.
  std::vector<Entry> near(const Eigen::Vector2d& p, double radius_m) const;
  void clear() { *this = QuadTree(); }
  std::size_t size() const { return size_; }

 private:
  struct Cell {
    Eigen::Vector2d centre;
    double half_m;
    std::vector<Entry> entries;               ///< of a leaf
    std::unique_ptr<Cell> children[4];        ///< all or none
    bool contains(const Eigen::Vector2d& p) const {
      return (p - centre).cwiseAbs().maxCoeff() <= half_m;
    }
  };
  static void insert(Cell& cell, const Entry& entry);
  static void collect(const Cell& cell, const Eigen::Vector2d& p, double radius_m, std::vector<Entry>& out);

  std::unique_ptr<Cell> root_;
  std::size_t size_ = 0;
};

}  // namespace modslam
