// SPDX-License-Identifier: BSD-3-Clause
#include "procs/doctor/diagnosis.hpp"

#include <algorithm>
#include <cstdio>

namespace modslam::doctor {
namespace {

constexpr std::int64_t kGoodBuffer = 2 << 20;
constexpr double kScarce = 1e9, kGone = 5e7;  // bytes of disk
constexpr double kSilent_s = 1.5;
constexpr double kLag_s = 0.10;
constexpr double kBlindShare = 0.9;
constexpr std::int64_t kSlow_us = 100'000;

template <class... Values>
std::string words(const char* format, Values... values) {
  char text[400];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void diagnose_stream(const char* name, const Stream& stream, const Run& run, bool needed, std::vector<Finding>& findings) {
  if (stream.messages == 0) {
    if (needed) findings.push_back({true, words("%s: nothing came within %.0f s. Is its driver running, and on this port?", name, run.listened_s)});
    return;
  }
  if (const double silent_s = run.listened_s - stream.last_heard_s; silent_s > kSilent_s)
    findings.push_back({true, words("%s has been silent for %.1f s.", name, silent_s)});
  if (stream.backward_steps > 0)
    findings.push_back({false, words("%s: stamps step back (%lld times in %.0f s). Is its clock being set, or do two drivers speak?", name,
                                     static_cast<long long>(stream.backward_steps), run.listened_s)});
  if (stream.repeated > 0)
    findings.push_back({false, words("%s: %lld stamps came twice.", name, static_cast<long long>(stream.repeated))});
}

void diagnose_sensors(const Run& run, std::vector<Finding>& findings) {
  diagnose_stream("The laser", run.laser, run, true, findings);
  diagnose_stream("Odometry", run.odometry, run, run.laser.messages > 0, findings);
  diagnose_stream("The INS", run.ins, run, false, findings);
  const double behind_s = median(run.odometry_behind_s);
  if (behind_s > kLag_s)
    findings.push_back({true, words("Odometry lags the laser by %.0f ms: scans wait for it, then go without. Do both stamp with the same clock?",
                                    1e3 * behind_s)});
  if (behind_s < -kLag_s)
    findings.push_back({false, words("The laser lags odometry by %.0f ms.", -1e3 * behind_s)});
  if (run.beams > 0 && static_cast<double>(run.beams_without_return) > kBlindShare * static_cast<double>(run.beams))
    findings.push_back({true, words("%.0f %% of the laser's beams return nothing: is it covered, or does SENSOR_INFO say the wrong range limits?",
                                    100.0 * static_cast<double>(run.beams_without_return) / static_cast<double>(run.beams))});
  if (run.laser.messages > 10 && run.pose.messages == 0)
    findings.push_back({true, "The laser speaks, but there is no POSE: is an estimator running, and the scan matcher?"});
}

void diagnose_process(const std::string& name, const process_status_t& status, std::vector<Finding>& findings) {
  std::int64_t received = 0, bad = 0, lost = 0;
  for (const channel_count_t& in : status.inputs) received += in.received, bad += in.bad, lost += in.gaps;
  if (status.state == process_status_t::TROUBLED) findings.push_back({true, name + " is in trouble: " + status.words});
  if (bad > 0)
    findings.push_back({false, words("%s dropped %lld messages that it could not use; its log names them.", name.c_str(), static_cast<long long>(bad))});
  if (lost > 0)
    findings.push_back({lost * 50 > received, words("%s lost %lld of %lld messages on the way: the network or the receive buffer.", name.c_str(),
                                                    static_cast<long long>(lost), static_cast<long long>(lost + received))});
  if (status.latency_p99_us > kSlow_us)
    findings.push_back({false, words("%s needs up to %.0f ms for a message: is the machine busy?", name.c_str(), 1e-3 * static_cast<double>(status.latency_p99_us))});
}

}  // namespace

void Stream::take(std::int64_t utime, double now_s) {
  if (messages == 0) first_utime = utime;
  backward_steps += messages > 0 && utime < last_utime;
  repeated += messages > 0 && utime == last_utime;
  last_utime = utime;
  last_heard_s = now_s;
  ++messages;
}

double Stream::rate_hz() const {
  const double span_s = 1e-6 * static_cast<double>(last_utime - first_utime);
  return span_s > 0 ? static_cast<double>(messages - 1) / span_s : 0;
}

std::vector<Finding> diagnose(const Machine& machine) {
  std::vector<Finding> findings;
  if (!machine.multicast.empty()) findings.push_back({true, "The bus cannot work: " + machine.multicast});
  if (machine.receive_buffer < kGoodBuffer)
    findings.push_back({false, words("A socket's receive buffer is at most %lld kB: bursts of map tiles may be lost (they are asked for again). As root: "
                                     "sysctl -w net.core.rmem_max=4194304",
                                     static_cast<long long>(machine.receive_buffer / 1024))});
  if (!machine.folder_writable) findings.push_back({true, machine.folder + " cannot be written: no run can be recorded."});
  if (machine.disk_free < kGone)
    findings.push_back({true, words("The disk is full: %.0f MB are left in %s.", machine.disk_free / 1e6, machine.folder.c_str())});
  else if (machine.disk_free < kScarce)
    findings.push_back({false, words("The disk is nearly full: %.0f MB are left in %s; an hour of driving needs about 200.", machine.disk_free / 1e6,
                                     machine.folder.c_str())});
  if (!machine.java) findings.push_back({false, "There is no java: no spy, and no replay faster than UDP. Type: apt-get install default-jre"});
  return findings;
}

std::vector<Finding> diagnose(const Run& run) {
  std::vector<Finding> findings;
  for (const std::string& name : run.expected)
    if (!run.status.count(name)) findings.push_back({true, words("%s has said nothing for %.0f s.", name.c_str(), run.listened_s)});
  for (const auto& [name, pids] : run.pids)
    if (pids.size() > 1)
      findings.push_back({true, words("%zu processes call themselves %s: it was just started again, or another robot speaks on this port.", pids.size(),
                                      name.c_str())});
  diagnose_sensors(run, findings);
  for (const auto& [name, status] : run.status) diagnose_process(name, status, findings);
  return findings;
}

}  // namespace modslam::doctor
