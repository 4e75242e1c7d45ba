// SPDX-License-Identifier: BSD-3-Clause
/// @file Things by number, for lists of which only the news are passed on.
#pragma once
#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <utility>
#include <vector>

namespace modslam {

using Numbers = std::vector<std::size_t>;

/// What became of a set of numbered things from one round to the next. What is gone can be read until the next round.
struct NumberNews {
  Numbers gone, come;
  bool empty() const { return gone.empty() && come.empty(); }
};

/// A number that was given back is given out again from the next round on; until then its thing can be read.
template <class Thing>
class Slots {
 public:
  void next_round() {
    free_.insert(free_.end(), gone_.begin(), gone_.end());
    gone_.clear();
  }
  std::size_t take(Thing thing) {
    if (free_.empty()) {
      things_.push_back(std::move(thing));
      return things_.size() - 1;
    }
    const std::size_t number = free_.back();
    free_.pop_back();
    things_[number] = std::move(thing);
    return number;
  }
  void give_back(std::size_t number) { gone_.push_back(number); }

  Thing& operator[](std::size_t number) { return things_[number]; }
  const Thing& operator[](std::size_t number) const { return things_[number]; }
  /// All numbers are below this.
  std::size_t end() const { return things_.size(); }

 private:
  std::vector<Thing> things_;
  Numbers free_, gone_;
};

/// Makes them rise, each once.
inline void tidy(Numbers& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

/// Rising, each once.
inline Numbers together(std::initializer_list<const Numbers*> lists) {
  Numbers all;
  for (const Numbers* numbers : lists) all.insert(all.end(), numbers->begin(), numbers->end());
  tidy(all);
  return all;
}

/// @param doubtful  numbers that may have come or gone, others have not. @param was, is  say whether a number belonged and belongs.
template <class Was, class Is>
NumberNews news_among(const Numbers& doubtful, Was was, Is is) {
  NumberNews news;
  for (const std::size_t number : doubtful)
    if (const bool now = is(number); now != was(number)) (now ? news.come : news.gone).push_back(number);
  return news;
}

}  // namespace modslam
