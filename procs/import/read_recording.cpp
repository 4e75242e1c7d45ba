// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>

#include "common/formats/file_bytes.hpp"
#include "common/formats/text_log.hpp"
#include "procs/import/import.hpp"

namespace modslam {
namespace {

bool is_rawlog(const std::string& path) {
  for (const char* end : {".rawlog", ".rawlog.gz", ".rawlog.xz"}) {
    const std::string tail(end);
    if (path.size() >= tail.size() &&
        path.compare(path.size() - tail.size(), tail.size(), tail) == 0)
      return true;
  }
  return false;
}

}  // namespace

Recording read_recording(const std::string& path) {
  const FileBytes file = read_file_bytes(path);
  try {
    Recording recording = is_rawlog(path) ? read_rawlog(file.bytes) : read_text_log(file.bytes);
    if (!file.damage.empty()) recording.complain("what follows: " + file.damage);
    return recording;
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(path + ": " + error.what() +
                             (file.damage.empty() ? "" : "; " + file.damage));
  }
}

}  // namespace modslam
