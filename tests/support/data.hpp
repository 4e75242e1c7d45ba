// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdlib>
#include <string>

namespace modslam {

/// A file of the measuring data that lies beside the source folder on developers' machines (or
/// where the environment variable MODSLAM_SHARED says). Tests on it are skipped, with words, where
/// it is absent.
inline std::string shared_file(const std::string& name) {
  const char* folder = std::getenv("MODSLAM_SHARED");
  return (folder ? std::string(folder) : std::string(MODSLAM_SOURCE_DIR "/../shared")) + "/" + name;
}

}  // namespace modslam
