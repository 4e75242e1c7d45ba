// SPDX-License-Identifier: BSD-3-Clause
/// Any bytes as an (unpacked) MRPT rawlog.
#include <stdexcept>

#include "procs/import/import.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    modslam::read_rawlog(std::string(reinterpret_cast<const char*>(data), size));
  } catch (const std::runtime_error&) {
  }
  return 0;
}
