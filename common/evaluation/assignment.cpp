// SPDX-License-Identifier: BSD-3-Clause
#include "common/evaluation/assignment.hpp"

#include <limits>

namespace modslam {
namespace {

/// @pre rows <= columns. Rows enter one by one; each takes the cheapest augmenting path through
/// reduced costs.
std::vector<int> assign_each_row(const Eigen::MatrixXd& cost) {
  const int rows = static_cast<int>(cost.rows()), columns = static_cast<int>(cost.cols());
  std::vector<double> row_price(rows + 1, 0.0), column_price(columns + 1, 0.0);
  std::vector<int> row_of(columns + 1,
                          0);  // 1-based; 0 = free, and column 0 holds the row that enters
  for (int entering = 1; entering <= rows; ++entering) {
    std::vector<double> shortest(columns + 1, std::numeric_limits<double>::infinity());
    std::vector<int> from(columns + 1, 0);
    std::vector<bool> done(columns + 1, false);
    int column = 0;
    row_of[0] = entering;
    do {
      done[column] = true;
      const int row = row_of[column];
      double step = std::numeric_limits<double>::infinity();
      int next = 0;
      for (int j = 1; j <= columns; ++j) {
        if (done[j]) continue;
        const double reduced = cost(row - 1, j - 1) - row_price[row] - column_price[j];
        if (reduced < shortest[j]) shortest[j] = reduced, from[j] = column;
        if (shortest[j] < step) step = shortest[j], next = j;
      }
      for (int j = 0; j <= columns; ++j) {
        if (done[j])
          row_price[row_of[j]] += step, column_price[j] -= step;
        else
          shortest[j] -= step;
      }
      column = next;
    } while (row_of[column] != 0);
    for (; column != 0; column = from[column]) row_of[column] = row_of[from[column]];
  }
  std::vector<int> column_of(rows, -1);
  for (int j = 1; j <= columns; ++j)
    if (row_of[j] != 0) column_of[row_of[j] - 1] = j - 1;
  return column_of;
}

}  // namespace

std::vector<int> assign(const Eigen::MatrixXd& cost) {
  if (cost.rows() <= cost.cols()) return assign_each_row(cost);
  const std::vector<int> row_of = assign_each_row(cost.transpose());
  std::vector<int> column_of(static_cast<std::size_t>(cost.rows()), -1);
  for (std::size_t j = 0; j < row_of.size(); ++j) column_of[row_of[j]] = static_cast<int>(j);
  return column_of;
}

}  // namespace modslam
