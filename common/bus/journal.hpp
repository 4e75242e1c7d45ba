// SPDX-License-Identifier: BSD-3-Clause
/// @file What a process writes down so that it goes on where it was when it is killed.
///
/// An LCM event log of its own in the run's folder. Each record is in the hands of the system when write() returns: that survives
/// kill -9, though not a power cut. When the disk is full the process goes on without a journal and says so.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/log.hpp"
#include "common/config/visitor.hpp"

namespace modslam {

struct JournalConfig {
  static constexpr const char* kTable = "journal";
  std::string folder;

  void visit(ConfigVisitor& v) { v.text("folder", folder, "Where processes write what they need after a crash; empty: nowhere."); }
};

class Journal {
 public:
  enum Mode { kAppend, kReadOnly };
  /// Goes on behind what an earlier life of `process` wrote. An empty folder: keeps nothing.
  /// @throws std::runtime_error when the folder cannot be written.
  Journal(const JournalConfig& config, const std::string& process, Mode mode = kAppend);

  /// Hands out what was there at the start, oldest first, once. It is read record by record: a long run's journal costs time, not memory.
  void read_past(const std::function<void(const LogEvent&)>& each);
  /// [us] of wall time when the last of it was written; 0 when there was none or it was not read yet.
  std::int64_t last_us() const { return last_us_; }

  bool on() const { return writer_ != nullptr; }
  void write(const std::string& channel, const void* bytes, int size);
  template <class Message>
  void write(const std::string& channel, const Message& message) {
    if (!on()) return;
    buffer_.resize(static_cast<std::size_t>(message.getEncodedSize()));
    message.encode(buffer_.data(), 0, static_cast<int>(buffer_.size()));
    write(channel, buffer_.data(), static_cast<int>(buffer_.size()));
  }
  /// "" or why the journal has ended, for words().
  const std::string& trouble() const { return trouble_; }

 private:
  std::unique_ptr<LogReader> past_;
  std::int64_t last_us_ = 0;
  std::unique_ptr<LogWriter> writer_;
  std::vector<std::uint8_t> buffer_;
  std::string trouble_;
};

/// A record as a message. @return false when it is none (a torn or foreign record).
template <class Message>
bool read_record(const LogEvent& record, Message& message) {
  const int size = static_cast<int>(record.bytes.size());
  try {
    return message.decode(record.bytes.data(), 0, size) == size;
  } catch (const std::exception&) {  // a wild array length
    return false;
  }
}

}  // namespace modslam
