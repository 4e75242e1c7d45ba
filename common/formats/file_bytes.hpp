// SPDX-License-Identifier: BSD-3-Clause
/// @file The bytes of a file, unpacked when it is compressed (gzip, xz). What it is shows in its
/// first bytes.
#pragma once
#include <string>

namespace modslam {

struct FileBytes {
  std::string bytes;
  std::string
      damage;  ///< "" or why `bytes` is only the front part, e.g. a compressed file that was cut
};

/// @throws std::runtime_error naming the file: missing, unreadable, empty, or nothing of it can be
/// unpacked. xz files need the program xz.
FileBytes read_file_bytes(const std::string& path);

}  // namespace modslam
