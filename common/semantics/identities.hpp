// SPDX-License-Identifier: BSD-3-Clause
/// @file Ids that outlast updates: what is found anew is the old thing that it is most like.
#pragma once
#include "common/semantics/types.hpp"

namespace modslam {

class Identities {
 public:
  /// Fills in the ids of `now` that are 0, at the ends of its lists, after those of `before`; what is like nothing before gets a new one. Fills in the
  /// events of the rooms.
  void carry_over(const SemanticLayers& before, SemanticLayers& now);

 private:
  std::int64_t next_wall_ = 1, next_door_ = 1, next_room_ = 1, next_object_ = 1;
};

}  // namespace modslam
