// SPDX-License-Identifier: BSD-3-Clause
/// @file Random draws that are the same on every machine and independent of each other.
///
/// The generator of the standard library is exact, its distributions are not: each library draws
/// them its own way. So they are written out here.
#pragma once
#include <cmath>
#include <cstdint>
#include <random>

#include "common/geometry/pose2.hpp"

namespace modslam {

/// Who draws. Changing how often one stream is used never changes another.
enum class RandomStreamId : std::uint64_t { kOdometry = 1, kLaser = 2, kIns = 3 };

class RandomStream {
 public:
  /// `index` numbers independent parts of one stream, e.g. the sweeps of a laser: then a part that
  /// is left out does not change those after it.
  RandomStream(std::uint64_t seed, RandomStreamId stream, std::uint64_t index = 0)
      : generator_(mix(mix(mix(seed) + static_cast<std::uint64_t>(stream)) + index)) {}

  /// Evenly from [0, 1).
  double uniform() { return static_cast<double>(generator_() >> 11) * 0x1.0p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Standard normal, by Box and Muller; always two draws, so that callers stay in step.
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * kPi * uniform());
  }

 private:
  /// splitmix64: neighbouring seeds give unrelated generators.
  static std::uint64_t mix(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15ull;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
  }

  std::mt19937_64 generator_;
};

}  // namespace modslam
