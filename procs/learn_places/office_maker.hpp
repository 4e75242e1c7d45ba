// SPDX-License-Identifier: BSD-3-Clause
/// @file Made-up office buildings: narrow and wide corridors with rooms of all sizes, for which few plans are at hand.
#pragma once
#include <cstdint>

#include "common/world/world.hpp"

namespace modslam {

/// A corridor with rooms on both sides, often with another corridor across its end, and a route `tour` through all of it. Another seed, another
/// building.
World make_office(std::uint64_t seed);

}  // namespace modslam
