// SPDX-License-Identifier: BSD-3-Clause
/// @file What a verdict of scan_match_t means to a person.
#pragma once
#include <modslam/scan_match_t.hpp>

namespace modslam {

/// The scan agreed with what was known; a first scan has nothing to disagree with.
inline bool is_good(int verdict) {
  return verdict == scan_match_t::OK || verdict == scan_match_t::FIRST;
}

inline const char* verdict_word(int verdict) {
  static const char* const kWords[] = {"invalid",     "ok",           "degenerate", "ambiguous",
                                       "low overlap", "inconsistent", "failed",     "first"};
  return verdict >= 0 && verdict <= scan_match_t::FIRST ? kWords[verdict] : kWords[0];
}

}  // namespace modslam
