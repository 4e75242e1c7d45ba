// SPDX-License-Identifier: BSD-3-Clause
/// @file The table [places].
#pragma once
#include "common/config/visitor.hpp"

namespace modslam {

struct PlacesConfig {
  static constexpr const char* kTable = "places";
  std::string model = "config/places.yml";

  void visit(ConfigVisitor& v) {
    v.text("model", model, "Trained classifiers of places (run.sh train places); empty: places are not told apart.");
  }
};

}  // namespace modslam
