// SPDX-License-Identifier: BSD-3-Clause
/// @file Answers that are kept until what they were worked out from changes.
#pragma once
#include <unordered_map>

#include "common/semantics/boxes.hpp"

namespace modslam {

/// Each answer stands with the box of cells that it was read from; a change that meets the box takes the answer away. So what is asked again after a change
/// is what a fresh look at everything would say, and only what lies near the change costs anything.
template <class Key, class Answer>
class Memo {
 public:
  /// Call before the questions of a round: answers near `changed` go, and those that nobody asked for in the last round.
  void forget(const Boxes& changed) {
    const cv::Rect all = bounds(changed);
    for (auto entry = kept_.begin(); entry != kept_.end();) {
      Kept& kept = entry->second;
      const bool goes = kept.round != round_ || (meet(all, kept.from) && meet(changed, kept.from));
      entry = goes ? kept_.erase(entry) : std::next(entry);
    }
    ++round_;
  }
  /// The raster grew. @param visit  is shown the answers.
  template <class Visit>
  void grow(const Growth& growth, Visit visit) {
    for (auto& [key, kept] : kept_) {
      kept.from += growth.shift;
      visit(kept.answer);
    }
  }

  /// @param from  cells that the answer depends on. @param work_out  makes the answer.
  template <class WorkOut>
  const Answer& ask(const Key& key, const cv::Rect& from, WorkOut work_out) {
    auto found = kept_.find(key);
    if (found == kept_.end() || found->second.from != from) found = kept_.insert_or_assign(key, Kept{from, 0, work_out()}).first;
    found->second.round = round_;
    return found->second.answer;
  }

 private:
  struct Kept {
    cv::Rect from;
    int round;
    Answer answer;
  };
  std::unordered_map<Key, Kept> kept_;
  int round_ = 0;
};

}  // namespace modslam
