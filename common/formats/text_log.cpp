// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/text_log.hpp"

#include <cmath>
#include <stdexcept>

#include "common/formats/tick_log.hpp"

namespace modslam {
namespace {

constexpr double kDegree = kPi / 180.0;
constexpr double kMaxStamp_s = 1e11;  // the year 5138
constexpr std::int64_t kMaxBeams = 20000;

std::int64_t utime(double stamp_s) {
  if (stamp_s < 0) throw BadLine("has a stamp before 0");
  return std::llround(stamp_s * 1e6);
}

/// Negative ranges become 0, a missing return; `negative` counts them.
std::vector<float> read_ranges(TextFields& fields, std::int64_t count, double metres,
                               std::int64_t& negative) {
  if (fields.left() < static_cast<std::size_t>(count))
    throw BadLine("promises " + std::to_string(count) + " ranges and ends before");
  std::vector<float> ranges_m;
  ranges_m.reserve(static_cast<std::size_t>(count));
  for (std::int64_t i = 0; i < count; ++i) {
    const double range_m = fields.number("a range", 1e9) * metres;
    if (range_m < 0) ++negative;
    ranges_m.push_back(range_m < 0 ? 0.0f : static_cast<float>(range_m));
  }
  return ranges_m;
}

/// ipc_timestamp ipc_hostname logger_timestamp, the end of each CARMEN line.
std::int64_t read_carmen_stamp(TextFields& fields) {
  fields.expect_left(3);
  return utime(fields.number("ipc_timestamp", kMaxStamp_s));
}

void read_odometry(TextFields& fields, Recording& recording, bool wean) {
  fields.pose("odometry pose");
  if (wean) {
    fields.expect_left(1);
  } else {
    for (const char* what : {"tv", "rv", "acceleration"}) fields.number(what);
    fields.expect_left(3);
  }
  utime(fields.number("stamp", kMaxStamp_s));
  ++recording.odometry_entries;
}

/// PARAM robot_frontlaser_offset: the laser's place ahead of the robot. Headers are often wrong
/// about it.
void read_parameter(TextFields& fields, Recording& recording) {
  ++recording.other_entries;
  if (fields.left() == 0 || fields.word("a name") != "robot_frontlaser_offset") return;
  recording.T_base_laser = Pose2(fields.number("robot_frontlaser_offset", 100), 0, 0);
}

void read_entry(std::string_view line, TickLog& ticks, Recording& recording) {
  TextFields fields(line);
  if (fields.size() > 0 && fields[0].find_first_not_of("0123456789") == std::string_view::npos) return ticks.read(fields, recording);
  const std::string_view kind = fields.word("its first word");
  if (kind == "FLASER") return read_flaser(fields, recording);
  if (kind == "ROBOTLASER1") return read_robotlaser(fields, recording);
  if (kind == "L") return read_wean_laser(fields, recording);
  if (kind == "ODOM" || kind == "O") return read_odometry(fields, recording, kind == "O");
  if (kind == "PARAM") return read_parameter(fields, recording);
  ++recording.other_entries;
}

}  // namespace

std::pair<double, double> flaser_bearings(std::size_t beams) {
  const std::size_t steps = beams % 2 == 1 && beams > 1 ? beams - 1 : beams;
  return {-kPi / 2, kPi / static_cast<double>(steps)};
}

// FLASER n ranges... laser_x laser_y laser_theta odom_x odom_y odom_theta stamp host stamp. Both
// poses are of the robot in some logs and one is corrected in others, so they tell nothing of the
// mount.
void read_flaser(TextFields& fields, Recording& recording) {
  RecordedScan recorded;
  std::int64_t negative = 0;
  const std::int64_t beams = fields.integer("the number of readings", 1, kMaxBeams);
  recorded.scan.ranges_m = read_ranges(fields, beams, 1.0, negative);
  fields.pose("laser pose");
  recorded.T_odom_base = fields.pose("odometry pose");
  recorded.scan.utime = read_carmen_stamp(fields);
  std::tie(recorded.scan.rad0, recorded.scan.radstep) =
      flaser_bearings(recorded.scan.ranges_m.size());
  recording.negative_ranges += negative;
  recording.scans.push_back(std::move(recorded));
}

// ROBOTLASER1 type start_angle fov resolution max_range accuracy remission_mode n ranges... m
// remissions... laser pose, robot pose, tv rv forward_safety side_safety turn_axis stamp host
// stamp.
void read_robotlaser(TextFields& fields, Recording& recording) {
  RecordedScan recorded;
  std::int64_t negative = 0;
  fields.number("laser_type");
  recorded.scan.rad0 = fields.number("start_angle", 4 * kPi);
  fields.number("field_of_view", 4 * kPi);
  recorded.scan.radstep = fields.number("angular_resolution", kPi);
  const double max_range_m = fields.number("maximum_range", 1e6);
  fields.number("accuracy");
  fields.number("remission_mode");
  const std::int64_t beams = fields.integer("num_readings", 1, kMaxBeams);
  if (std::abs(recorded.scan.radstep) * static_cast<double>(beams) > 4 * kPi)
    throw BadLine("has beam angles of more than two turns");
  recorded.scan.ranges_m = read_ranges(fields, beams, 1.0, negative);
  const std::int64_t remissions = fields.integer("num_remissions", 0, kMaxBeams);
  for (std::int64_t i = 0; i < remissions; ++i) fields.number("a remission");
  recorded.T_odom_laser = fields.pose("laser pose");
  recorded.T_odom_base = fields.pose("robot pose");
  for (const char* what : {"tv", "rv", "forward_safety_dist", "side_safety_dist", "turn_axis"})
    fields.number(what);
  recorded.scan.utime = read_carmen_stamp(fields);
  recording.negative_ranges += negative;
  recording.range_limit_m = std::max(recording.range_limit_m, max_range_m);
  recording.scans.push_back(std::move(recorded));
}

// L x y theta laser_x laser_y laser_theta r1 ... r180 stamp; lengths in centimetres, ranges from
// right to left.
void read_wean_laser(TextFields& fields, Recording& recording) {
  constexpr double kCentimetre = 0.01;
  constexpr std::int64_t kBeams = 180;
  RecordedScan recorded;
  std::int64_t negative = 0;
  recorded.T_odom_base = fields.pose("robot pose", kCentimetre);
  recorded.T_odom_laser = fields.pose("laser pose", kCentimetre);
  fields.expect_left(kBeams + 1);
  recorded.scan.ranges_m = read_ranges(fields, kBeams, kCentimetre, negative);
  recorded.scan.utime = utime(fields.number("stamp", kMaxStamp_s));
  recorded.scan.rad0 = -kPi / 2;
  recorded.scan.radstep = kDegree;
  recording.negative_ranges += negative;
  recording.scans.push_back(std::move(recorded));
}

Recording read_text_log(std::string_view text) {
  Recording recording;
  TickLog ticks;
  std::int64_t lines = 0;
  std::string first_words;
  for_each_line(text, [&](std::size_t number, std::string_view line) {
    if (++lines == 1) first_words = std::string(line.substr(0, 40));
    try {
      read_entry(line, ticks, recording);
    } catch (const BadLine& bad) {
      recording.complain("line " + std::to_string(number) + " " + bad.what());
    }
  });
  if (!recording.scans.empty()) return recording;
  for (char& c : first_words)
    if (c < ' ' || c > '~') c = '?';
  std::string why = "holds no usable laser sweep in " + std::to_string(lines) +
                    " lines; expected lines that start with FLASER, "
                    "ROBOTLASER1, L or a stamp, and the first is '" +
                    first_words + "'";
  if (!recording.complaints.empty()) why += "; " + recording.complaints.front();
  throw std::runtime_error(why);
}

}  // namespace modslam
