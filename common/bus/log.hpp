// SPDX-License-Identifier: BSD-3-Clause
/// @file Reads and writes LCM event logs. The reader survives what the stock reader ends at silently:
/// a broken magic word, wild lengths, a cut tail; it finds the next event and counts what it skipped. It holds a piece of the file at
/// a time, so that a log may be larger than memory.
#pragma once
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

namespace modslam {

struct LogEvent {
  std::int64_t number = 0;
  std::int64_t utime = 0;      ///< [us] when it was logged
  std::string channel;
  std::vector<char> bytes;
};

class LogReader {
 public:
  /// @throws std::runtime_error when the file is missing, unreadable, empty or holds no event at all.
  /// @param last_bytes reads only so much of its end, from the first whole event in it.
  explicit LogReader(const std::string& path, std::size_t last_bytes = static_cast<std::size_t>(-1));
  /// @return false at the end.
  bool next(LogEvent& event);
  /// Whether only the end of the file was read.
  bool is_tail() const { return tail_; }
  std::int64_t skipped_bytes() const { return skipped_bytes_; }
  /// "" or e.g. "skipped 812 bytes in 2 places, first at byte 40960".
  std::string damage() const;

 private:
  bool parse(LogEvent& event);
  const char* bytes(std::size_t at, std::size_t count);
  bool is_magic(std::size_t at);
  void seek_magic();
  std::string path_;
  std::ifstream in_;
  std::size_t begin_ = 0, end_ = 0;  ///< of the part that is read; a file that grows meanwhile is read up to where it ended
  std::vector<char> piece_;
  std::size_t piece_at_ = 0;
  bool tail_ = false;
  std::size_t at_ = 0;
  std::int64_t skipped_bytes_ = 0, skipped_places_ = 0, first_skip_ = 0;
};

class LogWriter {
 public:
  enum Mode {
    kWhole,   ///< writes beside `path` and takes its name in close(): there is the whole file, or the old one
    kAppend,  ///< writes to `path` itself, after what is there: readable at any moment, however it ends
  };
  /// @throws std::runtime_error when it cannot be written.
  explicit LogWriter(const std::string& path, Mode mode = kWhole);
  ~LogWriter();
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;
  void write(std::int64_t utime, const std::string& channel, const void* bytes, int size);
  template <class Message>
  void write(std::int64_t utime, const std::string& channel, const Message& message) {
    std::vector<std::uint8_t> buffer(static_cast<std::size_t>(message.getEncodedSize()));
    message.encode(buffer.data(), 0, static_cast<int>(buffer.size()));
    write(utime, channel, buffer.data(), static_cast<int>(buffer.size()));
  }
  /// Hands what was written to the system. @throws std::runtime_error (disk full).
  void flush();
  /// Flushes to disk and renames. @throws std::runtime_error (disk full, read-only).
  void close();

 private:
  std::string path_, temporary_;
  Mode mode_;
  std::FILE* file_ = nullptr;
  std::int64_t number_ = 0;
};

}  // namespace modslam
