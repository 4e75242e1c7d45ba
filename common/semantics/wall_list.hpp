// SPDX-License-Identifier: BSD-3-Clause
/// @file The list that others see, kept in step with numbered walls: most of it is not touched from one update to the next.
#pragma once
#include "common/semantics/slots.hpp"
#include "common/semantics/types.hpp"

namespace modslam {

class WallList {
 public:
  bool has(std::size_t number) const { return number < place_of_.size() && place_of_[number] != kNone; }
  /// @param list  as the last call left it, but for ids, which stay; walls that come have none and stand at the end. @param altered  of those that stay,
  /// others than in the list are left alone. @param wall_of  makes a wall from its number. @return walls that went.
  template <class WallOf>
  std::vector<Wall> update(std::vector<Wall>& list, const NumberNews& news, const Numbers& altered, WallOf wall_of) {
    std::vector<Wall> gone;
    for (const std::size_t number : news.gone) gone.push_back(take_out(list, number));
    for (const std::size_t number : altered) {
      if (!has(number)) continue;
      Wall& wall = list[place_of_[number]];
      const std::int64_t id = wall.id;
      wall = wall_of(number);
      wall.id = id;
    }
    for (const std::size_t number : news.come) {
      if (number >= place_of_.size()) place_of_.resize(number + 1, kNone);
      place_of_[number] = list.size();
      numbers_.push_back(number);
      list.push_back(wall_of(number));
    }
    return gone;
  }

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  /// The last one takes its place.
  Wall take_out(std::vector<Wall>& list, std::size_t number) {
    const std::size_t place = std::exchange(place_of_[number], kNone);
    const Wall gone = list[place];
    if (place + 1 < list.size()) {
      list[place] = list.back();
      numbers_[place] = numbers_.back();
      place_of_[numbers_[place]] = place;
    }
    list.pop_back();
    numbers_.pop_back();
    return gone;
  }

  std::vector<std::size_t> place_of_;  ///< by number
  Numbers numbers_;                    ///< by place
};

}  // namespace modslam
