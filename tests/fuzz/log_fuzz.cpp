// SPDX-License-Identifier: BSD-3-Clause
/// Any bytes as an LCM log: the reader ends, and what it gives and what it skips add up to the file.
#include <cstdlib>
#include <stdexcept>

#include "common/bus/log.hpp"
#include "tests/fuzz/memory_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::int64_t kHeader = 28;
  const modslam::fuzz::MemoryFile file(data, size);
  try {
    modslam::LogReader reader(file.path());
    std::int64_t read = 0;
    for (modslam::LogEvent event; reader.next(event);)
      read += kHeader + static_cast<std::int64_t>(event.channel.size() + event.bytes.size());
    if (read + reader.skipped_bytes() != static_cast<std::int64_t>(size)) std::abort();
    modslam::LogReader(file.path(), size / 2);
  } catch (const std::runtime_error&) {  // no event at all
  }
  return 0;
}
