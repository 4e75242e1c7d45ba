// SPDX-License-Identifier: BSD-3-Clause
/// Any bytes as a configuration: what is accepted prints to something that is accepted and prints the same.
#include <cstdlib>

#include "common/bus/config.hpp"
#include "tests/fuzz/memory_file.hpp"

using namespace modslam;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const fuzz::MemoryFile file(data, size);
    const std::string printed = to_toml(load_config(file.path()), false);
    const fuzz::MemoryFile again(reinterpret_cast<const std::uint8_t*>(printed.data()), printed.size());
    if (to_toml(load_config(again.path()), false) != printed) std::abort();
  } catch (const ConfigError&) {
  }
  return 0;
}
