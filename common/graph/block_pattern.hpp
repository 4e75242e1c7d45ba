// SPDX-License-Identifier: BSD-3-Clause
/// @file Which blocks of a sparse symmetric matrix and of its Cholesky factor differ from zero.
///
/// The matrix has one row and column of blocks per variable; a link between two variables makes the block between them. The
/// pattern depends on the links alone, so one analysis serves every matrix over them, whatever its numbers or its block size.
#pragma once
#include <utility>
#include <vector>

namespace modslam {

/// Pattern of the factor L in the order that fills least (approximate minimum degree). "Place" is a variable's row in that order.
class BlockPattern {
 public:
  using Link = std::pair<int, int>;

  /// @param variables  count of block rows.
  /// @param links      pairs of different variables; repeats do no harm. A negative one is no variable and is left out.
  BlockPattern(int variables, const std::vector<Link>& links);

  int variables() const { return static_cast<int>(place_.size()); }
  int place(int variable) const { return place_[static_cast<std::size_t>(variable)]; }
  /// Blocks of L below the diagonal.
  int blocks() const { return column_start_.back(); }
  /// Column `c` of L below the diagonal is entries begin(c) .. begin(c + 1) - 1; rows ascend.
  int begin(int c) const { return column_start_[static_cast<std::size_t>(c)]; }
  int row(int entry) const { return rows_[static_cast<std::size_t>(entry)]; }
  /// Entry of L at places row > column, which must be part of the pattern.
  int entry(int row, int column) const;

 private:
  std::vector<int> place_, column_start_, rows_;
};

}  // namespace modslam
