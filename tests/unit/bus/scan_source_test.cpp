// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/scan_source.hpp"

#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "tests/support/matchers.hpp"

using namespace modslam;

namespace {

struct Setup {
  void scan(std::int64_t utime, int beams = 1) {
    Scan scan;
    scan.utime = utime;
    scan.ranges_m.assign(static_cast<std::size_t>(beams), 1.0f);
    sender.publish(channel::kLaser, to_message(scan));
    drain();
  }
  void odometry(std::int64_t utime, double x) {
    sender.publish(channel::kOdometry, to_message(TimedPose{utime, {x, 0, 0}, 0}));
    drain();
  }
  void drain() {
    while (transport.poll(0)) {
    }
  }
  Transport transport{"memq://"};
  Bus bus{transport, "listener"}, sender{transport, "sender"};
  std::vector<std::pair<std::int64_t, double>> got;  ///< time and x of odometry
  ScanSource source{bus, channel::kOdometry, [this](const Scan& s, const Pose2& pose) { got.emplace_back(s.utime, pose.x); }};
};

using Got = std::vector<std::pair<std::int64_t, double>>;

}  // namespace

TEST_CASE("a scan waits for odometry on both sides of its time and gets the place between") {
  Setup s;
  s.odometry(1000, 1.0);
  s.scan(1500);
  REQUIRE(s.got.empty());
  s.odometry(2000, 2.0);
  REQUIRE(s.got == Got{{1500, 1.5}});
  REQUIRE(s.source.without_odometry() == 0);
}

TEST_CASE("scans keep the order in which they came") {
  Setup s;
  s.odometry(1000, 1.0);
  s.scan(1800);
  s.scan(1200);  // a stamp that steps back
  s.odometry(2000, 2.0);
  REQUIRE(s.got == Got{{1800, 1.8}, {1200, 1.2}});
}

TEST_CASE("a scan older than all odometry is handed on and counted, not kept for ever") {
  Setup s;
  s.scan(500);
  REQUIRE(s.got.empty());
  s.odometry(1000, 1.0);
  REQUIRE(s.got == Got{{500, 1.0}});
  REQUIRE(s.source.without_odometry() == 1);
}

TEST_CASE("when odometry stays away patience ends after half a second of newer scans") {
  Setup s;
  s.odometry(0, 3.0);
  for (int k = 1; k <= 6; ++k) s.scan(100'000 * k);
  REQUIRE(s.got.empty());
  s.scan(700'000);
  REQUIRE(s.got == Got{{100'000, 3.0}});
  s.source.flush();
  REQUIRE(s.got.size() == 7);
  REQUIRE(s.source.without_odometry() == 7);
}

TEST_CASE("a scan that cannot be is dropped and counted, those after it go on") {
  Setup s;
  s.odometry(0, 0.0);
  s.scan(100, 0);
  s.scan(200);
  s.odometry(300, 0.3);
  REQUIRE(s.got.size() == 1);
  REQUIRE(s.bus.inputs().at(channel::kLaser).received == 2);
  REQUIRE(s.bus.inputs().at(channel::kLaser).bad == 1);
}

TEST_CASE("the mount is taken from messages about the laser only") {
  Setup s;
  SensorInfo info;
  info.T_base_laser = {0.2, 0, 0};
  sensor_info_t message = to_message(info, 0);
  s.sender.publish(channel::kSensorInfo, message);
  message.sensor = "SONAR";
  message.T_base_sensor[0] = 9;
  s.sender.publish(channel::kSensorInfo, message);
  s.drain();
  REQUIRE(s.source.sensor().T_base_laser.x == 0.2);
}
