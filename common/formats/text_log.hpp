// SPDX-License-Identifier: BSD-3-Clause
/// @file Reads laser logs that are text, one entry a line, known by its first word alone.
///
/// CARMEN (metres): FLASER, ROBOTLASER1, ODOM, PARAM robot_frontlaser_offset. Wean (centimetres): L
/// and O. Lines of numbers alone: wheel ticks and a URG's sweep (tick_log.hpp). Source: the format lines that CARMEN writes at the head of its logs.
#pragma once
#include <string_view>

#include "common/formats/recording.hpp"
#include "common/formats/text_fields.hpp"

namespace modslam {

/// A broken line is counted, the first few are named by their number, and skipped.
/// @throws std::runtime_error when there is no usable sweep in it.
Recording read_text_log(std::string_view text);

/// Bearings of a CARMEN FLASER sweep: 180 degrees from -90; an odd number of beams ends at +90, an
/// even one a step before. @return (rad0, radstep).
std::pair<double, double> flaser_bearings(std::size_t beams);

/// One entry whose first word has been read. @throws BadLine; then `recording` is unchanged.
void read_flaser(TextFields& fields, Recording& recording);
void read_robotlaser(TextFields& fields, Recording& recording);
void read_wean_laser(TextFields& fields, Recording& recording);

}  // namespace modslam
