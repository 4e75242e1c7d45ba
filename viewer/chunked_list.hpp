// SPDX-License-Identifier: BSD-3-Clause
/// @file Puts the chunks of a SEMANTIC_ list together.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"

namespace modslam {

/// Collects the chunks of one version at a time; chunks of another version make it start anew,
/// because that is a newer list or one of a restarted sender.
template <class Message>
class ChunkedList {
 public:
  /// @return all chunks in order once the last of them is here.
  /// @throws BadMessage on impossible chunk numbers.
  std::optional<std::vector<Message>> add(const Message& message) {
    constexpr std::int32_t kMaxChunks = 10'000;
    if (message.nchunks < 1 || message.nchunks > kMaxChunks || message.chunk < 0 ||
        message.chunk >= message.nchunks)
      throw BadMessage("chunk " + std::to_string(message.chunk) + " of " +
                       std::to_string(message.nchunks));
    if (message.version != version_ || message.nchunks != nchunks_) {
      incomplete_ += chunks_.empty() ? 0 : 1;
      chunks_.clear();
      version_ = message.version;
      nchunks_ = message.nchunks;
    }
    chunks_[message.chunk] = message;
    if (static_cast<std::int32_t>(chunks_.size()) < nchunks_) return std::nullopt;
    std::vector<Message> whole;
    for (auto& [number, chunk] : chunks_) whole.push_back(std::move(chunk));
    chunks_.clear();
    return whole;
  }

  /// Versions of which a chunk never came.
  std::int64_t incomplete() const { return incomplete_; }

 private:
  std::int64_t version_ = 0, incomplete_ = 0;
  std::int32_t nchunks_ = 0;
  std::map<std::int32_t, Message> chunks_;
};

}  // namespace modslam
