// SPDX-License-Identifier: BSD-3-Clause
#include <cstdarg>
#include <cstdio>

#include "common/evaluation/score_json.hpp"

namespace modslam {
namespace {

std::string row(const char* format, ...) __attribute__((format(printf, 1, 2)));
std::string row(const char* format, ...) {
  char line[512];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  return std::string(line) + "\n";
}

std::string statistics_row(const std::string& name, const Statistics& s) {
  if (s.count == 0) return row("%-34s nothing to score", name.c_str());
  return row("%-34s %6zu %9.4f %9.4f %9.4f %9.4f %9.4f", name.c_str(), s.count, s.mean, s.std,
             s.rms, s.median, s.max);
}

std::string head() {
  return row("%-34s %6s %9s %9s %9s %9s %9s", "", "count", "mean", "std", "rms", "median", "max");
}

std::string precision_row(const std::string& name, const PrecisionRecall& s) {
  return row("%-34s P %6.2f %%   R %6.2f %%   F1 %6.2f %%", name.c_str(), 100 * s.precision,
             100 * s.recall, 100 * s.f1());
}

}  // namespace

std::string to_table(const RelationScores& s, bool exact_only) {
  std::string out = head();
  if (!exact_only) {
    out += statistics_row("relations: translation [m]", s.all.translation_m);
    out += statistics_row("relations: rotation [deg]", s.all.rotation_deg);
  }
  out += statistics_row("exact stamps: translation [m]", s.exact.translation_m);
  out += statistics_row("exact stamps: rotation [deg]", s.exact.rotation_deg);
  if (s.unplaced > 0)
    out += row("%zu relations lie outside the log or the path: not scored", s.unplaced);
  return out;
}

std::string to_table(const TruthScores& s) {
  std::string out = head();
  out += statistics_row("first pose aligned: position [m]", s.first_pose.position_m);
  out += statistics_row("first pose aligned: heading [deg]", s.first_pose.heading_deg);
  out += statistics_row("least squares: position [m]", s.least_squares.position_m);
  out += statistics_row("least squares: heading [deg]", s.least_squares.heading_deg);
  for (const RelativeError& e : s.relative) {
    const std::string over = "over " + std::to_string(static_cast<int>(e.travelled_m)) + " m: ";
    out += statistics_row(over + "translation [m]", e.translation_m);
    out += statistics_row(over + "rotation [deg]", e.rotation_deg);
  }
  if (s.unpaired > 0)
    out += row("%zu poses have no true pose at their time: not scored", s.unpaired);
  return out;
}

std::string to_table(const SemanticScores& s) {
  std::string out;
  for (const WallScore& w : s.walls.at)
    out += precision_row("walls by length, within " +
                             std::to_string(static_cast<int>(w.tolerance_m * 100 + 0.5)) + " cm",
                         w.by_length);
  out += row("  found %.1f m in %zu pieces; true %.1f m in %zu, seen %.1f m; median error %.3f m",
             s.walls.found_m, s.walls.found_segments, s.walls.truth_m, s.walls.truth_segments,
             s.walls.visible_m, s.walls.median_error_m);
  if (s.wall_ends.told > 0)
    out += row("wall ends: %zu told, %zu of them on a true face; off by %.3f m along it (median; 95 %%: %.2f), %.0f %% within two sigma; across %.3f m, %.0f %%",
               s.wall_ends.told, s.wall_ends.on_face, s.wall_ends.along_m.median, s.wall_ends.along_m.p95, 100 * s.wall_ends.along_within,
               s.wall_ends.across_m.median, 100 * s.wall_ends.across_within);
  out += precision_row("rooms, IoU 0.5", s.rooms.at_half);
  out +=
      row("  found %zu, %zu of them right, %zu in unseen space; true %zu, explored %zu; mean IoU "
          "%.3f (matched %.3f)",
          s.rooms.found, s.rooms.matched, s.rooms.false_in_unseen, s.rooms.truth,
          s.rooms.explored_truth, s.rooms.mean_iou, s.rooms.mean_matched_iou);
  out += precision_row("doors, 0.5 m", s.doors.at_half_metre);
  out += precision_row("doors, both jambs 0.5 m", s.doors.strict);
  out +=
      row("  found %zu, %zu of them right; true %zu, visible and open %zu; width error %.3f m; "
          "rooms right %zu of %zu",
          s.doors.found, s.doors.matched, s.doors.truth, s.doors.visible_truth,
          s.doors.median_width_error_m, s.doors.pairs_right, s.doors.pairs_known);
  out += row("objects: found %zu, %zu of them things that are there (IoU 0.3) of %zu; %zu named, %zu rightly", s.objects.found, s.objects.matched,
             s.objects.truth, s.objects.named, s.objects.named_right);
  return out;
}

}  // namespace modslam
