// SPDX-License-Identifier: BSD-3-Clause
/// @file A message as lines of text, and its number in its stream.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace modslam {

/// Fields of a message by its channel, one a line, arrays shortened; a hexadecimal beginning for
/// what is not known or broken.
std::vector<std::string> describe_message(const std::string& channel,
                                          const std::vector<std::uint8_t>& bytes);

/// seq or id of the messages of numbered streams; -1 for others.
std::int64_t message_number(const std::string& channel, const void* bytes, std::size_t size);

}  // namespace modslam
