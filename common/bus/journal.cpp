// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/journal.hpp"

#include <chrono>
#include <filesystem>

namespace modslam {
namespace {

std::int64_t wall_clock_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace

Journal::Journal(const JournalConfig& config, const std::string& process, Mode mode) {
  if (config.folder.empty()) return;
  const std::string path = config.folder + "/" + process + ".journal";
  std::error_code error;
  if (mode == kAppend) std::filesystem::create_directories(config.folder, error);
  if (std::filesystem::is_regular_file(path, error) && std::filesystem::file_size(path, error) > 0) {
    try {
      past_ = std::make_unique<LogReader>(path);
    } catch (const std::runtime_error&) {  // no whole record in it: killed while it wrote the first
    }
  }
  if (mode == kAppend) writer_ = std::make_unique<LogWriter>(path, LogWriter::kAppend);
}

void Journal::read_past(const std::function<void(const LogEvent&)>& each) {
  for (LogEvent record; past_ && past_->next(record);) {
    last_us_ = record.utime;
    each(record);
  }
  past_.reset();
}

void Journal::write(const std::string& channel, const void* bytes, int size) {
  if (!on()) return;
  try {
    writer_->write(wall_clock_us(), channel, bytes, size);
    writer_->flush();
  } catch (const std::runtime_error& error) {
    trouble_ = std::string("journal ended: ") + error.what();
    writer_.reset();
  }
}

}  // namespace modslam
