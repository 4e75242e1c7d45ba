// SPDX-License-Identifier: BSD-3-Clause
/// modslam-doctor: looks at the machine and, when one is going on, at a run, and says in plain words what is wrong.
/// Exit code 0: nothing serious; 1: something is.
#include <sys/socket.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <bot_core/planar_lidar_t.hpp>
#include <bot_core/pose_t.hpp>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <modslam/pose_estimate_t.hpp>

#include "common/bus/bus.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/process.hpp"
#include "procs/doctor/diagnosis.hpp"

namespace modslam::doctor {
namespace {

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// What the kernel grants of a large wish; it tells twice of what it grants.
std::int64_t largest_receive_buffer() {
  const int fd = socket(AF_INET, SOCK_DGRAM, 0), wish = 64 << 20;
  int granted = 0;
  socklen_t size = sizeof granted;
  setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &wish, sizeof wish);
  getsockopt(fd, SOL_SOCKET, SO_RCVBUF, &granted, &size);
  close(fd);
  return granted / 2;
}

Machine look_at_machine(const std::string& folder) {
  Machine machine;
  machine.multicast = preflight("udpm://239.255.76.67:7667?ttl=0");
  machine.receive_buffer = largest_receive_buffer();
  machine.folder = folder;
  machine.folder_writable = access(folder.c_str(), W_OK) == 0;
  struct statvfs disk {};
  if (statvfs(folder.c_str(), &disk) == 0) machine.disk_free = static_cast<double>(disk.f_bavail) * static_cast<double>(disk.f_frsize);
  machine.java = std::system("command -v java >/dev/null 2>&1") == 0;  // NOLINT: a fixed command
  return machine;
}

Run listen(const std::string& url, double seconds, const std::vector<std::string>& expected) {
  Transport transport(url);
  Bus bus(transport, "doctor");
  Run run;
  run.expected = expected;
  const double start = now_s();
  const auto time = [&] { return now_s() - start; };
  bus.subscribe<bot_core::planar_lidar_t>(channel::kLaser, [&](const bot_core::planar_lidar_t& m) {
    run.laser.take(m.utime, time());
    if (run.odometry.messages > 0) run.odometry_behind_s.push_back(1e-6 * static_cast<double>(m.utime - run.odometry.last_utime));
    run.beams += m.nranges;
    for (const float range_m : m.ranges) run.beams_without_return += !(range_m > 0.0f && range_m < 1000.0f);
  });
  bus.subscribe<bot_core::pose_t>(channel::kOdometry, [&](const bot_core::pose_t& m) { run.odometry.take(m.utime, time()); });
  bus.subscribe<bot_core::pose_t>(channel::kIns, [&](const bot_core::pose_t& m) { run.ins.take(m.utime, time()); });
  bus.subscribe<pose_estimate_t>(channel::kPose, [&](const pose_estimate_t& m) { run.pose.take(m.utime, time()); });
  bus.subscribe<process_status_t>(channel::kStatus, [&](const process_status_t& m) {
    run.status[m.name] = m;
    run.pids[m.name].insert(m.pid);
  });
  while (time() < seconds) transport.poll(20);
  run.listened_s = time();
  return run;
}

/// @return whether one of them is serious.
bool print(const std::vector<Finding>& findings) {
  bool serious = false;
  for (const Finding& finding : findings) {
    std::cout << (finding.serious ? "  WRONG  " : "  note   ") << finding.words << "\n";
    serious = serious || finding.serious;
  }
  return serious;
}

}  // namespace
}  // namespace modslam::doctor

int main(int argc, char** argv) {
  using namespace modslam::doctor;
  std::string url, folder = ".";
  double seconds = 4;
  bool no_run = false;
  std::vector<std::string> expected;
  CLI::App app("Says in plain words what is wrong with the machine and the run");
  app.add_option("--url", url, "LCM url of the run")->envname("LCM_DEFAULT_URL");
  app.add_option("--seconds", seconds, "how long to listen")->capture_default_str();
  app.add_option("--folder", folder, "where runs are written")->capture_default_str();
  app.add_flag("--no-run", no_run, "look at the machine only");
  app.add_option("processes", expected, "that should be speaking");
  CLI11_PARSE(app, argc, argv);
  try {
    std::cout << "The machine:\n";
    const Machine machine = look_at_machine(folder);
    bool serious = print(diagnose(machine));
    if (!serious) std::cout << "  fine   the bus works here\n";
    if (no_run || url.empty()) {
      std::cout << "No run is going on.\n";
      return serious ? 1 : 0;
    }
    std::cout << "The run, listening for " << seconds << " s:\n" << std::flush;
    const Run run = listen(url, seconds, expected);
    const bool run_serious = print(diagnose(run));
    if (!run_serious)
      std::cout << "  fine   " << run.status.size() << " processes speak, laser " << run.laser.rate_hz() << " Hz, odometry " << run.odometry.rate_hz()
                << " Hz of their own time\n";
    return serious || run_serious ? 1 : 0;
  } catch (const std::exception& error) {
    std::cerr << "doctor: " << error.what() << std::endl;
    return 1;
  }
}
