// SPDX-License-Identifier: BSD-3-Clause
/// @file A foreign recording becomes an LCM log that explains itself.
#pragma once
#include <optional>
#include <string>

#include "common/bus/log.hpp"
#include "common/formats/recording.hpp"

namespace modslam {

struct ImportOptions {
  std::optional<Pose2> T_base_laser;  ///< over what the file states
  std::optional<double> no_return_m;  ///< over what is found
};

/// What was assumed about the laser, for the summary line.
struct ImportedSensor {
  SensorInfo sensor;
  std::optional<double> no_return_m;
  std::string mount_source;  ///< who says where the laser is
};
ImportedSensor choose_sensor(const Recording& recording, const ImportOptions& options);

/// Writes SENSOR_INFO first and every 5 s; for each sweep, in file order, ODOMETRY and LASER with
/// the sweep's utime. Event times never step back, message times do when the file's did.
void write_log(const Recording& recording, const SensorInfo& sensor, LogWriter& log);

/// The line (and complaints) for a person.
std::string describe(const Recording& recording, const ImportedSensor& sensor);

/// Reads `path` by its kind: an MRPT rawlog by its name's end, else a text log; .gz and .xz are
/// unpacked.
/// @throws std::runtime_error naming the file.
Recording read_recording(const std::string& path);

/// MRPT rawlog: 2D range scans and odometry, as observations or as actions that are summed up.
/// `bytes`: the file, unpacked. @throws std::runtime_error when there is no usable sweep.
Recording read_rawlog(const std::string& bytes);

}  // namespace modslam
