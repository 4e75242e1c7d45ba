// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/object_class.hpp"

#include <catch2/catch.hpp>
#include <limits>

using namespace modslam;

TEST_CASE("a footprint with the size of a car, a sofa, a chair or a plant is one, whichever side is told first") {
  for (const auto& [name, a, b] : {std::tuple("car", 4.4, 1.9), std::tuple("sofa", 2.15, 0.85), std::tuple("chair", 0.7, 0.55), std::tuple("plant", 0.42, 0.34)}) {
    INFO(name);
    REQUIRE(classify_footprint(a, b).name == name);
    REQUIRE(classify_footprint(b, a).name == name);
    REQUIRE(classify_footprint(a, b).confidence >= 0.6);
    REQUIRE(classify_footprint(a, b).confidence <= 1);
  }
}

TEST_CASE("what may be two things, or is like nothing known, is not named") {
  for (const auto& [a, b] : {std::pair(1.7, 0.52), std::pair(5.5, 0.9), std::pair(0.1, 0.1), std::pair(40.0, 30.0), std::pair(0.0, 0.0),
                             std::pair(std::numeric_limits<double>::quiet_NaN(), 1.0), std::pair(1.0, std::numeric_limits<double>::infinity())}) {
    INFO(a << " x " << b);
    REQUIRE(classify_footprint(a, b).name.empty());
    REQUIRE(classify_footprint(a, b).confidence == 0);
  }
}

TEST_CASE("the farther a footprint is from the size of a car, the less sure it is that it is one") {
  double before = 1.01;
  for (const double length_m : {4.45, 4.8, 5.0, 5.2}) {
    const ObjectClass guess = classify_footprint(length_m, 1.95);
    INFO(length_m);
    REQUIRE(guess.confidence < before);
    before = guess.confidence;
  }
}
