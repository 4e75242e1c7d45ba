// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/tum_writer.hpp"

#include <cinttypes>
#include <cstdio>
#include <cstdlib>

namespace modslam {

std::string tum_text(const std::vector<PathPose>& path) {
  std::string text;
  text.reserve(path.size() * 100);
  char line[256];
  for (const PathPose& p : path) {
    // Integers, because a double has no room for the microseconds of today's stamps and their
    // digits.
    const std::int64_t second = p.utime / 1'000'000, rest = std::abs(p.utime % 1'000'000);
    std::snprintf(line, sizeof line, "%s%" PRId64 ".%06" PRId64 " %.9f %.9f 0 0 0 %.9f %.9f\n",
                  p.utime < 0 && second == 0 ? "-" : "", second, rest, p.pose.x, p.pose.y,
                  std::sin(p.pose.heading / 2), std::cos(p.pose.heading / 2));
    text += line;
  }
  return text;
}

}  // namespace modslam
