// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/wall_set.hpp"

#include <functional>

namespace modslam {

std::size_t WallSet::Hash::operator()(const Ends& ends) const {
  std::size_t hash = 0;
  for (const double x : ends) hash = hash * 1000003 + std::hash<double>()(x);
  return hash;
}

std::size_t WallSet::number_for(const Wall& wall) {
  std::size_t number = walls_.size();
  if (free_.empty()) {
    walls_.push_back(wall);
    places_.push_back(0);
  } else {
    number = free_.back();
    free_.pop_back();
    walls_[number] = wall;
  }
  index_.add(wall.a, wall.b, number);
  return number;
}

WallSet::News WallSet::update(const std::vector<Wall>& walls) {
  News news;
  free_.insert(free_.end(), gone_.begin(), gone_.end());
  std::vector<std::size_t> numbers;
  numbers.reserve(walls.size());
  std::vector<bool> stays(walls_.size(), false);
  std::size_t expected = 0;  // lists change little: most walls follow the one they followed before
  for (const Wall& wall : walls) {
    const Ends ends = ends_of(wall);
    std::size_t number = 0;
    if (expected < numbers_.size() && ends_of(walls_[numbers_[expected]]) == ends) {
      number = numbers_[expected++];
    } else if (const auto known = number_of_.find(ends); known != number_of_.end()) {
      number = known->second;
      if (number < stays.size()) expected = places_[number] + 1;
    } else {
      number = number_for(wall);
      number_of_.emplace(ends, number);
      news.come.push_back(number);
    }
    if (number < stays.size()) stays[number] = true;
    walls_[number] = wall;
    numbers.push_back(number);
  }
  for (const std::size_t number : numbers_)
    if (!stays[number]) {
      stays[number] = true;  // walls with the same ends share a number
      news.gone.push_back(number);
      number_of_.erase(ends_of(walls_[number]));
      index_.remove(walls_[number].a, walls_[number].b, number);
    }
  numbers_ = std::move(numbers);
  for (std::size_t k = 0; k < numbers_.size(); ++k) places_[numbers_[k]] = k;
  gone_ = news.gone;
  return news;
}

}  // namespace modslam
