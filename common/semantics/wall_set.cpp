// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/wall_set.hpp"

namespace modslam {

WallSet::WallSet(const std::vector<Wall>& walls) {
  for (std::size_t k = 0; k < walls.size(); ++k) put(k, walls[k]);
}

void WallSet::put(std::size_t number, const Wall& wall) {
  if (number >= walls_.size()) {
    walls_.resize(number + 1);
    is_in_.resize(number + 1, false);
  }
  walls_[number] = wall;
  is_in_[number] = true;
  ++size_;
  index_.add_line(wall.a, wall.b, number);
}

void WallSet::drop(std::size_t number) {
  is_in_[number] = false;
  --size_;
  index_.remove_line(walls_[number].a, walls_[number].b, number);
}

void WallSet::take(const NumberNews& news, const Slots<Wall>& walls) {
  for (const std::size_t number : news.gone) drop(number);
  for (const std::size_t number : news.come) put(number, walls[number]);
}

Numbers WallSet::numbers() const {
  Numbers out;
  for (std::size_t number = 0; number < is_in_.size(); ++number)
    if (is_in_[number]) out.push_back(number);
  return out;
}

}  // namespace modslam
