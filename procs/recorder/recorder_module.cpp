// SPDX-License-Identifier: BSD-3-Clause
/// procs/recorder — everything but SIM_STATE → the run's LCM log; SYNC_REQUEST for what the log lacks. Config: [recorder].
/// The stock lcm-logger keeps 30 messages a subscription and drops the rest when the machine is busy; this one drops none that reached it.
/// Every message is in the hands of the system as soon as it came: processes that are started again read what they missed in this log.
#include <chrono>
#include <filesystem>
#include <modslam/sync_request_t.hpp>
#include <set>

#include "common/bus/bus.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/log.hpp"
#include "common/bus/modules.hpp"
#include "common/bus/system_config.hpp"

namespace modslam {
namespace {

constexpr std::int64_t kAskEvery_us = 500'000;
constexpr std::uint64_t kMaxNodes = 10'000'000;
constexpr int kMostQuestions = 6;  // when nothing is known to be missing

std::int64_t wall_clock_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
}

class RecorderModule : public Module {
 public:
  RecorderModule(Bus& bus, const SystemConfig& config) : bus_(bus), path_(config.recorder.path) {
    read_own_log();
    log_ = std::make_unique<LogWriter>(path_, LogWriter::kAppend);
    bus.subscribe_bytes([this](const std::string& channel, const void* bytes, int size) { record(channel, bytes, size); });
  }

  void tick(std::int64_t steady_us) override {
    if (steady_us - asked_us_ < kAskEvery_us) return;
    asked_us_ = steady_us;
    if (trouble_.empty() && has_gap()) ask();
  }
  void missed(const std::string& channel) override {
    if (channel != channel::kNode && channel != channel::kGraph && channel != channel::kMapTile && channel.rfind("SEMANTIC", 0) != 0) return;
    suspicious_ = true;
    questions_ = 0;
  }
  bool complete() const override { return !has_gap(); }
  bool troubled() const override { return !trouble_.empty(); }
  std::string words() const override {
    if (!trouble_.empty()) return trouble_;
    return std::to_string(events_) + " messages recorded" + (goes_on_ ? " behind those of an earlier life" : "");
  }

 private:
  void record(const std::string& channel, const void* bytes, int size) {
    if (channel == channel::kSimState || channel == channel::kRepeat || channel == "LCM_SELF_TEST") return;
    if (channel == channel::kNode) note_node(bytes, size);
    if (channel == channel::kGraph && is_snapshot(bytes, size)) suspicious_ = false;
    if (!trouble_.empty()) return;
    try {
      log_->write(wall_clock_us(), channel, bytes, size);
      log_->flush();
      ++events_;
    } catch (const std::runtime_error& error) {  // disk full: what is there stays, and the robot drives on
      trouble_ = std::string("recording has ended: ") + error.what();
    }
  }

  /// A recorder that is started again goes on behind what is there and asks for the part of the graph that it missed.
  void read_own_log() {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path_, error) || std::filesystem::file_size(path_, error) == 0) return;
    try {
      LogReader reader(path_);
      for (LogEvent event; reader.next(event);) {
        if (event.channel == channel::kNode) note_node(event.bytes.data(), static_cast<int>(event.bytes.size()));
        bus_.note_past(event.channel, event.bytes.data(), static_cast<int>(event.bytes.size()));
      }
    } catch (const std::runtime_error&) {  // nothing whole in it yet
    }
    goes_on_ = true;
  }

  /// A message begins with the type's fingerprint and its time; then a node has its id, and an update seq, epoch, snapshot.
  void note_node(const void* bytes, int size) {
    if (size < 24) return;
    std::uint64_t id = 0;
    for (int k = 16; k < 24; ++k) id = id << 8 | static_cast<const unsigned char*>(bytes)[k];
    if (id >= static_cast<std::uint64_t>(next_node_) && id < kMaxNodes) early_.insert(static_cast<std::int64_t>(id));
    while (early_.count(next_node_)) early_.erase(next_node_++);
    if (!has_gap()) questions_ = 0;
  }

  static bool is_snapshot(const void* bytes, int size) { return size > 32 && static_cast<const char*>(bytes)[32] != 0; }

  bool has_gap() const { return suspicious_ || !early_.empty(); }

  void ask() {
    if (++questions_ == kMostQuestions) suspicious_ = false;  // there may be no graph yet
    sync_request_t message{};
    message.utime = bus_.utime();
    message.requester = bus_.name();
    message.from_node = next_node_;
    bus_.publish(channel::kSyncRequest, message);
  }

  Bus& bus_;
  std::string path_;
  std::unique_ptr<LogWriter> log_;
  std::set<std::int64_t> early_;  ///< nodes behind a gap
  std::int64_t next_node_ = 0, events_ = 0, asked_us_ = 0;
  int questions_ = 0;
  bool suspicious_ = true, goes_on_ = false;  ///< there may be a part of the graph that nobody will tell unasked
  std::string trouble_;
};

}  // namespace

std::unique_ptr<Module> make_recorder(Bus& bus, const SystemConfig& config) {
  return std::make_unique<RecorderModule>(bus, config);
}

}  // namespace modslam
