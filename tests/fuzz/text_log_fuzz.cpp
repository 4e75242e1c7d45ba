// SPDX-License-Identifier: BSD-3-Clause
/// Any bytes as a CARMEN or Wean log: sweeps that come out are whole, or words say that there are none.
#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include "common/formats/text_log.hpp"
#include "procs/import/import.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const modslam::Recording recording = modslam::read_text_log({reinterpret_cast<const char*>(data), size});
    const modslam::ImportedSensor sensor = modslam::choose_sensor(recording, {});
    if (modslam::describe(recording, sensor).empty()) std::abort();
  } catch (const std::runtime_error&) {
  }
  return 0;
}
