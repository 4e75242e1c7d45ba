// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/log.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <fstream>

#include "common/world/random.hpp"
#include "tests/support/temporary_folder.hpp"

using namespace modslam;
using Catch::Matchers::Contains;
using test::TemporaryFolder;

namespace {

constexpr int kEvents = 50;
constexpr std::size_t kEventBytes = 28 + 1 + 40;  // header, channel "C", data

/// A log of kEvents events of equal size; event k holds 40 times the byte k.
struct SmallLog {
  SmallLog() {
    LogWriter writer(path);
    for (int k = 0; k < kEvents; ++k) {
      const std::string data(40, static_cast<char>(k));
      writer.write(1000 + k, "C", data.data(), 40);
    }
    writer.close();
    std::ifstream in(path, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(in), {});
  }
  /// Numbers of the events that are read once the file holds `changed`.
  std::vector<int> read(const std::string& changed) {
    std::ofstream(path, std::ios::binary) << changed;
    LogReader reader(path);
    std::vector<int> numbers;
    for (LogEvent event; reader.next(event);) {
      REQUIRE(event.bytes == std::vector<char>(40, static_cast<char>(event.number)));
      REQUIRE(event.utime == 1000 + event.number);
      numbers.push_back(static_cast<int>(event.number));
    }
    skipped = reader.skipped_bytes();
    damage = reader.damage();
    return numbers;
  }
  TemporaryFolder folder;
  std::string path = folder.path + "/small.lcm", bytes, damage;
  std::int64_t skipped = 0;
};

}  // namespace

TEST_CASE("what was written is read, in order, without damage") {
  SmallLog log;
  REQUIRE(log.bytes.size() == kEvents * kEventBytes);
  REQUIRE(log.read(log.bytes).size() == kEvents);
  REQUIRE(log.skipped == 0);
  REQUIRE(log.damage.empty());
}

TEST_CASE("a log cut in its last event loses that event and says where") {
  SmallLog log;
  REQUIRE(log.read(log.bytes.substr(0, log.bytes.size() - 5)).size() == kEvents - 1);
  REQUIRE(log.skipped == static_cast<std::int64_t>(kEventBytes) - 5);
  REQUIRE_THAT(log.damage, Contains("skipped 64 bytes in 1 places, first at byte " + std::to_string(49 * kEventBytes)));
}

TEST_CASE("a flipped magic word costs its event and the one that can no longer be checked against it") {
  SmallLog log;
  std::string changed = log.bytes;
  changed[10 * kEventBytes] ^= 0x40;
  const auto numbers = log.read(changed);
  REQUIRE(numbers.size() == kEvents - 2);
  REQUIRE(std::count(numbers.begin(), numbers.end(), 10) == 0);
  REQUIRE(log.skipped == static_cast<std::int64_t>(2 * kEventBytes));
}

TEST_CASE("wild lengths cost one event, whether impossible, beyond the end, or plausible") {
  SmallLog log;
  const std::size_t channel_length = 20, data_length = 24;
  for (const auto& [at, value] : std::vector<std::pair<std::size_t, unsigned char>>{
           {channel_length, 0x7f}, {channel_length, 0xff}, {data_length, 0x7f}, {data_length, 0xff},
           {data_length + 2, 0x01}, {data_length + 3, 39}, {data_length + 3, 41}, {channel_length + 3, 0}}) {
    std::string changed = log.bytes;
    changed[20 * kEventBytes + at] = static_cast<char>(value);
    const auto numbers = log.read(changed);
    INFO("byte " << at << " = " << int(value));
    REQUIRE(numbers.size() == kEvents - 1);
    REQUIRE(log.skipped == static_cast<std::int64_t>(kEventBytes));
  }
}

TEST_CASE("noise between events and before the first is stepped over") {
  SmallLog log;
  const std::string noise = "not an event at all";
  const std::string changed = noise + log.bytes.substr(0, 5 * kEventBytes) + log.bytes.substr(5 * kEventBytes);
  REQUIRE(log.read(changed).size() == kEvents);
  REQUIRE(log.skipped == static_cast<std::int64_t>(noise.size()));
}

TEST_CASE("a log that is read in pieces loses no more than one of a piece") {
  constexpr std::size_t kBytes = 30'011;  // some forty events a piece, each across its edge elsewhere
  TemporaryFolder folder;
  const std::string path = folder.path + "/large.lcm";
  {
    LogWriter writer(path);
    const std::string data(kBytes, '\xED');  // as a magic word begins
    for (int k = 0; k < 200; ++k) writer.write(k, "C", data.data(), static_cast<int>(kBytes));
    writer.close();
  }
  {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    for (const int k : {30, 34, 35, 90}) {  // the piece's edge lies in or near the first three
      file.seekp(static_cast<std::streamoff>(k * (28 + 1 + kBytes) + 20));  // the length of its channel's name
      file.put('\x7f');
    }
  }
  LogReader reader(path);
  std::vector<std::int64_t> found;
  for (LogEvent event; reader.next(event);) {
    REQUIRE(event.bytes.size() == kBytes);
    found.push_back(event.utime);
  }
  CHECK(found.size() == 196);
  CHECK(std::is_sorted(found.begin(), found.end()));
  CHECK(reader.skipped_bytes() == static_cast<std::int64_t>(4 * (28 + 1 + kBytes)));
  LogReader tail(path, 100 * (28 + 1 + kBytes));
  LogEvent event;
  REQUIRE(tail.next(event));
  CHECK(tail.is_tail());
  CHECK(event.utime == 100);
}

TEST_CASE("two hundred logs with random bytes changed are read to their end") {
  SmallLog log;
  RandomStream random(141, RandomStreamId::kLaser);
  std::size_t read = 0;
  for (int round = 0; round < 200; ++round) {
    std::string changed = log.bytes;
    for (int k = 0; k < 5; ++k) {
      // Headers only, so that what is read can be compared.
      const std::size_t event = static_cast<std::size_t>(random.uniform(0, kEvents)), at = static_cast<std::size_t>(random.uniform(0, 28));
      if (at >= 4 && at < 20) continue;  // number and time carry no check
      changed[event * kEventBytes + at] = static_cast<char>(random.uniform(0, 256));
    }
    read += log.read(changed).size();
  }
  REQUIRE(read >= 200 * (kEvents - 10));
}

TEST_CASE("files that are no log are refused by name") {
  SmallLog log;
  REQUIRE_THROWS_WITH(LogReader("/nowhere.lcm"), Contains("/nowhere.lcm: there is no such file"));
  std::ofstream(log.path, std::ios::binary) << "";
  REQUIRE_THROWS_WITH(LogReader(log.path), Contains("small.lcm: holds no LCM event"));
  std::ofstream(log.path, std::ios::binary) << std::string(10000, 'x');
  REQUIRE_THROWS_WITH(LogReader(log.path), Contains("small.lcm: holds no LCM event"));
  REQUIRE_THROWS_WITH(LogReader(log.folder.path), Contains("there is no such file"));
}

TEST_CASE("a log takes its name only when it is whole, and a place that cannot be written is named") {
  TemporaryFolder folder;
  const std::string path = folder.path + "/new.lcm";
  {
    LogWriter writer(path);
    writer.write(1, "C", "x", 1);
    REQUIRE_FALSE(std::filesystem::exists(path));
  }
  REQUIRE(std::filesystem::is_empty(folder.path));
  REQUIRE_THROWS_WITH(LogWriter("/nowhere/at/all.lcm"), Contains("/nowhere/at/all.lcm"));
}
