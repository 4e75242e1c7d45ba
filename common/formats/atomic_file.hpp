// SPDX-License-Identifier: BSD-3-Clause
/// @file Files that are either whole or not there.
#pragma once
#include <string>
#include <string_view>

namespace modslam {

/// Writes `bytes` to a temporary beside `path`, syncs it to disk and gives it the name `path`.
/// On failure the previous file stays as it was and nothing is left behind.
/// @throws std::runtime_error naming the file and the reason (disk full, read-only, no such
/// folder).
void write_atomically(const std::string& path, std::string_view bytes);

}  // namespace modslam
