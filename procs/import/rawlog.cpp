// SPDX-License-Identifier: BSD-3-Clause
/// @file The only place that knows MRPT's rawlog: thin, because linking MRPT costs 170 libraries.
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CArchive.h>
#include <mrpt/system/datetime.h>

#include <cmath>
#include <stdexcept>

#include "procs/import/import.hpp"

namespace modslam {
namespace {

Pose2 planar(const mrpt::poses::CPose2D& pose) {
  return {pose.x(), pose.y(), wrap_angle(pose.phi())};
}

bool is_finite(const Pose2& p) {
  return std::isfinite(p.x + p.y + p.heading) && std::hypot(p.x, p.y) < 1e6;
}

/// Takes a rawlog's objects in file order.
class RawlogReader {
 public:
  void add(const mrpt::serialization::CSerializable::Ptr& object, const std::string& where) {
    using namespace mrpt::obs;
    if (const auto actions = std::dynamic_pointer_cast<CActionCollection>(object))
      return add_motion(*actions, where);
    if (const auto frame = std::dynamic_pointer_cast<CSensoryFrame>(object)) {
      for (const auto& observation : *frame) add_observation(*observation, where);
      return;
    }
    if (const auto observation = std::dynamic_pointer_cast<CObservation>(object))
      return add_observation(*observation, where);
    ++recording.other_entries;
  }

  Recording recording;

 private:
  void add_motion(mrpt::obs::CActionCollection& actions, const std::string& where) {
    const auto movement = actions.getBestMovementEstimation();
    if (!movement) return void(++recording.other_entries);
    const Pose2 step = planar(movement->poseChange->getMeanVal());
    if (!is_finite(step)) return recording.complain(where + " holds a motion that is not finite");
    T_odom_base_ = T_odom_base_ * step;
  }

  void add_observation(const mrpt::obs::CObservation& observation, const std::string& where) {
    if (const auto* odometry = dynamic_cast<const mrpt::obs::CObservationOdometry*>(&observation)) {
      const Pose2 pose = planar(odometry->odometry);
      if (!is_finite(pose)) return recording.complain(where + " holds odometry that is not finite");
      T_odom_base_ = pose;
      ++recording.odometry_entries;
    } else if (const auto* scan =
                   dynamic_cast<const mrpt::obs::CObservation2DRangeScan*>(&observation)) {
      add_scan(*scan, where);
    } else {
      ++recording.other_entries;
    }
  }

  void add_scan(const mrpt::obs::CObservation2DRangeScan& from, const std::string& where) {
    // A second laser would need a second mount: the first one is taken.
    if (recording.scans.empty() && label_.empty()) label_ = from.sensorLabel;
    if (from.sensorLabel != label_) return void(++recording.other_entries);
    const std::size_t beams = from.getScanSize();
    if (beams < 1 || beams > 20000 || !std::isfinite(from.aperture) ||
        std::abs(from.aperture) > 4 * kPi)
      return recording.complain(where + " holds a sweep of " + std::to_string(beams) +
                                " beams over " + std::to_string(from.aperture) + " rad");
    RecordedScan recorded;
    recorded.T_odom_base = T_odom_base_;
    recorded.scan.utime = std::llround(mrpt::system::timestampTotime_t(from.timestamp) * 1e6);
    if (recorded.scan.utime < 0)
      return recording.complain(where + " holds a sweep without a stamp");
    const double direction = from.rightToLeft ? 1.0 : -1.0;
    recorded.scan.rad0 = -direction * from.aperture / 2;
    recorded.scan.radstep =
        beams > 1 ? direction * from.aperture / static_cast<double>(beams - 1) : 0.0;
    for (std::size_t i = 0; i < beams; ++i) {
      const float range_m = from.getScanRange(i);
      if (range_m < 0) ++recording.negative_ranges;
      recorded.scan.ranges_m.push_back(from.getScanRangeValidity(i) && range_m > 0 ? range_m
                                                                                   : 0.0f);
    }
    const Pose2 mount(from.sensorPose.x(), from.sensorPose.y(), wrap_angle(from.sensorPose.yaw()));
    if (is_finite(mount) && !recording.T_base_laser) recording.T_base_laser = mount;
    recording.range_limit_m = std::max(recording.range_limit_m, static_cast<double>(from.maxRange));
    recording.scans.push_back(std::move(recorded));
  }

  Pose2 T_odom_base_;
  std::string label_;
};

}  // namespace

Recording read_rawlog(const std::string& bytes) {
  mrpt::io::CMemoryStream stream;
  stream.assignMemoryNotOwn(bytes.data(), bytes.size());
  auto archive = mrpt::serialization::archiveFrom(stream);
  RawlogReader reader;
  std::size_t objects = 0;
  while (stream.getPosition() < bytes.size()) {
    const std::string where = "object " + std::to_string(objects + 1) + " (byte " +
                              std::to_string(stream.getPosition()) + " unpacked)";
    try {
      reader.add(archive.ReadObject(), where);
      ++objects;
    } catch (const std::exception&) {  // its text is a stack trace and names no cause
      reader.recording.complain(where + " cannot be read, nor what follows");
      break;
    }
  }
  if (reader.recording.scans.empty())
    throw std::runtime_error(
        "holds no 2D laser sweep in the " + std::to_string(objects) +
        " objects that can be read; is it a whole MRPT rawlog?" +
        (reader.recording.complaints.empty() ? "" : " " + reader.recording.complaints.front()));
  return std::move(reader.recording);
}

}  // namespace modslam
