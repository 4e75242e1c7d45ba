// SPDX-License-Identifier: BSD-3-Clause
/// procs/import — a CARMEN, Wean, CoreSLAM or MRPT log → an LCM log with SENSOR_INFO, ODOMETRY, LASER.
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <iostream>

#include "procs/import/import.hpp"

namespace {

struct Arguments {
  std::string input, output;
  double laser_x_m = 0, laser_y_m = 0, laser_yaw_rad = 0, no_return_m = 0;
  bool mount_given = false, strict = false;
};

/// A wild length in a foreign file must end in bad_alloc, not in the machine's memory.
void limit_memory() {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  const rlimit limit{rlim_t{8} << 30, rlim_t{8} << 30};
  setrlimit(RLIMIT_DATA, &limit);
#endif
}

int import(const Arguments& arguments) {
  limit_memory();
  modslam::ImportOptions options;
  if (arguments.mount_given)
    options.T_base_laser =
        modslam::Pose2(arguments.laser_x_m, arguments.laser_y_m, arguments.laser_yaw_rad);
  if (arguments.no_return_m > 0) options.no_return_m = arguments.no_return_m;
  const modslam::Recording recording = modslam::read_recording(arguments.input);
  const modslam::ImportedSensor sensor = modslam::choose_sensor(recording, options);
  modslam::LogWriter log(arguments.output);
  modslam::write_log(recording, sensor.sensor, log);
  log.close();
  std::cout << arguments.output << ": " << modslam::describe(recording, sensor);
  return arguments.strict && recording.broken_entries > 0 ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app(
      "Makes an LCM log of a CARMEN log (.log, .clf), a Wean or CoreSLAM log or an MRPT rawlog; .gz and .xz "
      "are unpacked.");
  app.add_option("input", arguments.input, "the foreign log")->required();
  app.add_option("output", arguments.output, "the LCM log to write")->required();
  std::vector<CLI::Option*> mount = {
      app.add_option("--laser-x", arguments.laser_x_m,
                     "laser ahead of the robot's centre [m]; over what the file states"),
      app.add_option("--laser-y", arguments.laser_y_m, "laser left of it [m]"),
      app.add_option("--laser-yaw", arguments.laser_yaw_rad, "laser turned to the left [rad]")};
  app.add_option("--no-return", arguments.no_return_m,
                 "value of a missing return [m]; default: found in the log")
      ->check(CLI::PositiveNumber);
  app.add_flag("--strict", arguments.strict, "exit code 1 when anything was skipped as broken");
  CLI11_PARSE(app, argc, argv);
  for (const CLI::Option* option : mount) arguments.mount_given |= option->count() > 0;
  try {
    return import(arguments);
  } catch (const std::exception& error) {
    std::cerr << "modslam-import: " << error.what() << std::endl;
    return 1;
  }
}
