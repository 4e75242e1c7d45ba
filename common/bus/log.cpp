// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/log.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>

namespace modslam {
namespace {

// Event: magic u32 | number i64 | utime i64 | channel length i32 | data length i32 | channel | data; big-endian.
constexpr std::uint32_t kMagic = 0xEDA1DA01u;
constexpr std::size_t kHeader = 28;
constexpr std::uint64_t kMaxChannel = 63, kMaxData = 64u << 20;

std::uint64_t big_endian(const char* bytes, int count) {
  std::uint64_t value = 0;
  for (int i = 0; i < count; ++i) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

void append_big_endian(std::string& out, std::uint64_t value, int count) {
  for (int i = count - 1; i >= 0; --i) out.push_back(static_cast<char>(value >> (8 * i) & 0xff));
}

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw std::runtime_error(path + ": " + what + (errno ? std::string(": ") + std::strerror(errno) : ""));
}

}  // namespace

LogReader::LogReader(const std::string& path, std::size_t last_bytes) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    throw std::runtime_error(path + ": there is no such file");
  }
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in) fail(path, "cannot be opened");
  const std::size_t size = std::filesystem::file_size(path);
  file_.resize(std::min(size, last_bytes));
  tail_ = file_.size() < size;
  in.seekg(static_cast<std::streamoff>(size - file_.size()));
  in.read(file_.data(), static_cast<std::streamsize>(file_.size()));
  if (in.gcount() != static_cast<std::streamsize>(file_.size())) fail(path, "cannot be read");
  LogEvent event;
  if (!next(event)) throw std::runtime_error(path + ": holds no LCM event; is it an LCM log?");
  at_ = 0;
  skipped_bytes_ = skipped_places_ = first_skip_ = 0;
}

bool LogReader::parse(std::size_t at, LogEvent& event, std::size_t& end) const {
  if (file_.size() - at < kHeader || big_endian(&file_[at], 4) != kMagic) return false;
  const std::uint64_t channel_length = big_endian(&file_[at + 20], 4), data_length = big_endian(&file_[at + 24], 4);
  if (channel_length < 1 || channel_length > kMaxChannel || data_length > kMaxData) return false;
  end = at + kHeader + channel_length + data_length;
  if (end > file_.size()) return false;
  // A length that was damaged but stays plausible betrays itself: no event follows.
  if (end + 4 <= file_.size() && big_endian(&file_[end], 4) != kMagic) return false;
  event.number = static_cast<std::int64_t>(big_endian(&file_[at + 4], 8));
  event.utime = static_cast<std::int64_t>(big_endian(&file_[at + 12], 8));
  event.channel.assign(&file_[at + kHeader], channel_length);
  const char* data = file_.data() + at + kHeader + channel_length;
  event.bytes.assign(data, data + data_length);
  return true;
}

bool LogReader::next(LogEvent& event) {
  const std::size_t start = at_;
  while (at_ < file_.size()) {
    std::size_t end = 0;
    if (parse(at_, event, end)) break;
    ++at_;
    static const char magic[4] = {'\xED', '\xA1', '\xDA', '\x01'};
    at_ = static_cast<std::size_t>(
        std::search(file_.begin() + static_cast<std::ptrdiff_t>(at_), file_.end(), magic, magic + 4) -
        file_.begin());
  }
  if (at_ > start) {
    if (!skipped_places_++) first_skip_ = static_cast<std::int64_t>(start);
    skipped_bytes_ += static_cast<std::int64_t>(at_ - start);
  }
  if (at_ >= file_.size()) return false;
  at_ += kHeader + event.channel.size() + event.bytes.size();
  return true;
}

std::string LogReader::damage() const {
  if (!skipped_bytes_) return "";
  return "skipped " + std::to_string(skipped_bytes_) + " bytes in " + std::to_string(skipped_places_) +
         " places, first at byte " + std::to_string(first_skip_);
}

LogWriter::LogWriter(const std::string& path, Mode mode)
    : path_(path), temporary_(mode == kAppend ? path : path + ".part"), mode_(mode) {
  errno = 0;
  file_ = std::fopen(temporary_.c_str(), mode == kAppend ? "ab" : "wb");
  if (!file_) fail(temporary_, "cannot be written");
}

LogWriter::~LogWriter() {
  if (!file_) return;
  std::fclose(file_);
  if (mode_ == kWhole) std::remove(temporary_.c_str());
}

void LogWriter::flush() {
  errno = 0;
  if (std::fflush(file_) != 0) fail(temporary_, "cannot be written");
}

void LogWriter::write(std::int64_t utime, const std::string& channel, const void* bytes, int size) {
  std::string head;
  append_big_endian(head, kMagic, 4);
  append_big_endian(head, static_cast<std::uint64_t>(number_++), 8);
  append_big_endian(head, static_cast<std::uint64_t>(utime), 8);
  append_big_endian(head, channel.size(), 4);
  append_big_endian(head, static_cast<std::uint64_t>(size), 4);
  head += channel;
  errno = 0;
  if (std::fwrite(head.data(), 1, head.size(), file_) != head.size() ||
      std::fwrite(bytes, 1, static_cast<std::size_t>(size), file_) != static_cast<std::size_t>(size))
    fail(temporary_, "cannot be written");
}

void LogWriter::close() {
  errno = 0;
  const bool written = std::fflush(file_) == 0 && fsync(fileno(file_)) == 0;
  const bool closed = std::fclose(file_) == 0;
  file_ = nullptr;
  if (!written || !closed) fail(temporary_, "cannot be written");
  if (mode_ == kWhole && std::rename(temporary_.c_str(), path_.c_str()) != 0) fail(path_, "cannot be written");
}

}  // namespace modslam
