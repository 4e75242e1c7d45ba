// SPDX-License-Identifier: BSD-3-Clause
/// @file Ids that survive an update: each thing takes the id of the old thing that it overlaps
/// most; a new thing gets a new id.
#pragma once
#include "common/semantics/types.hpp"

namespace modslam {

class Identities {
 public:
  /// Fills in the ids (and the times of objects) of `now` from `before`.
  void carry_over(const Semantics& before, Semantics& now, std::int64_t utime);

 private:
  std::int64_t next_wall_ = 1, next_room_ = 1, next_door_ = 1, next_object_ = 1;
};

}  // namespace modslam
