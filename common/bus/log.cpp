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
constexpr std::size_t kPiece = 1 << 20;

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

LogReader::LogReader(const std::string& path, std::size_t last_bytes) : path_(path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    throw std::runtime_error(path + ": there is no such file");
  }
  errno = 0;
  in_.open(path, std::ios::binary);
  if (!in_) fail(path, "cannot be opened");
  end_ = std::filesystem::file_size(path);
  begin_ = at_ = end_ - std::min(end_, last_bytes);
  tail_ = begin_ > 0;
  LogEvent event;
  if (!next(event)) throw std::runtime_error(path + ": holds no LCM event; is it an LCM log?");
  at_ = begin_;
  skipped_bytes_ = skipped_places_ = first_skip_ = 0;
}

/// These bytes of the file, all of which it has; the next call moves them. @throws std::runtime_error when the disk fails.
const char* LogReader::bytes(std::size_t at, std::size_t count) {
  if (at < piece_at_ || at + count > piece_at_ + piece_.size()) {
    piece_.resize(std::min(std::max(count, kPiece), end_ - at));
    piece_at_ = at;
    errno = 0;
    in_.clear();
    in_.seekg(static_cast<std::streamoff>(at));
    in_.read(piece_.data(), static_cast<std::streamsize>(piece_.size()));
    if (in_.gcount() != static_cast<std::streamsize>(piece_.size())) fail(path_, "cannot be read");
  }
  return &piece_[at - piece_at_];
}

/// Looks without moving the piece: a wild length costs four bytes.
bool LogReader::is_magic(std::size_t at) {
  char word[4];
  if (at >= piece_at_ && at + 4 <= piece_at_ + piece_.size()) {
    std::copy_n(&piece_[at - piece_at_], 4, word);
  } else {
    in_.clear();
    in_.seekg(static_cast<std::streamoff>(at));
    if (!in_.read(word, 4)) return false;
  }
  return big_endian(word, 4) == kMagic;
}

bool LogReader::parse(LogEvent& event) {
  if (end_ - at_ < kHeader) return false;
  const char* const head = bytes(at_, kHeader);
  if (big_endian(head, 4) != kMagic) return false;
  const std::uint64_t channel_length = big_endian(head + 20, 4), data_length = big_endian(head + 24, 4);
  if (channel_length < 1 || channel_length > kMaxChannel || data_length > kMaxData) return false;
  const std::size_t size = kHeader + channel_length + data_length;
  if (size > end_ - at_) return false;
  // A length that was damaged but stays plausible betrays itself: no event follows.
  if (at_ + size + 4 <= end_ && !is_magic(at_ + size)) return false;
  const char* const whole = bytes(at_, size);
  event.number = static_cast<std::int64_t>(big_endian(whole + 4, 8));
  event.utime = static_cast<std::int64_t>(big_endian(whole + 12, 8));
  event.channel.assign(whole + kHeader, channel_length);
  event.bytes.assign(whole + kHeader + channel_length, whole + size);
  return true;
}

/// Goes on to the next magic word, or to the end.
void LogReader::seek_magic() {
  static const char magic[4] = {'\xED', '\xA1', '\xDA', '\x01'};
  ++at_;
  while (end_ - at_ >= sizeof magic) {
    const char* const first = bytes(at_, sizeof magic);
    const char* const last = piece_.data() + piece_.size();
    const char* const found = std::search(first, last, magic, magic + sizeof magic);
    at_ += static_cast<std::size_t>(found - first);
    if (found != last) return;
    at_ -= sizeof magic - 1;  // it may lie across the piece's end
    if (end_ - at_ < sizeof magic) break;
  }
  at_ = end_;
}

bool LogReader::next(LogEvent& event) {
  const std::size_t start = at_;
  while (at_ < end_ && !parse(event)) seek_magic();
  if (at_ > start) {
    if (!skipped_places_++) first_skip_ = static_cast<std::int64_t>(start - begin_);
    skipped_bytes_ += static_cast<std::int64_t>(at_ - start);
  }
  if (at_ >= end_) return false;
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
