// SPDX-License-Identifier: BSD-3-Clause
/// @file A fingerprint of bytes, so that a log can say which file it was made from.
#pragma once
#include <string>

namespace modslam {

/// SHA-256 in 64 hexadecimal digits. Source: FIPS 180-4, section 6.2.
std::string sha256(const std::string& bytes);

}  // namespace modslam
