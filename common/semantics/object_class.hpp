// SPDX-License-Identifier: BSD-3-Clause
/// @file What a thing that stands free may be, from the size of its footprint.
#pragma once
#include <string>

namespace modslam {

struct ObjectClass {
  std::string name;        ///< "": several would do, or none
  double confidence = 0;   ///< 0..1; 0 when unknown
};

/// @param long_m, short_m  sides of the smallest rectangle around the footprint, in any order
ObjectClass classify_footprint(double long_m, double short_m);

}  // namespace modslam
