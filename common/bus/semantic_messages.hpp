// SPDX-License-Identifier: BSD-3-Clause
/// @file The semantic map as messages: whole lists in numbered chunks below 60 kB, and their
/// assembly at the consumer.
#pragma once
#include <functional>
#include <map>
#include <modslam/door_list_t.hpp>
#include <modslam/object_list_t.hpp>
#include <modslam/room_list_t.hpp>
#include <modslam/wall_list_t.hpp>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/semantics/types.hpp"

namespace modslam {

/// Chunks of one version; an empty list is one empty chunk.
std::vector<wall_list_t> to_messages(const std::vector<Wall>& walls, std::int64_t utime,
                                     std::int64_t version);
std::vector<room_list_t> to_messages(const std::vector<Room>& rooms, std::int64_t utime,
                                     std::int64_t version);
std::vector<door_list_t> to_messages(const std::vector<Door>& doors, std::int64_t utime,
                                     std::int64_t version);
std::vector<object_list_t> to_messages(const std::vector<Object>& objects, std::int64_t utime,
                                       std::int64_t version);

/// Content of a chunk. @throws BadMessage on non-finite values, outlines of fewer than 3 corners,
/// unknown types.
std::vector<Wall> to_things(const wall_list_t& message);
std::vector<Room> to_things(const room_list_t& message);
std::vector<Door> to_things(const door_list_t& message);
std::vector<Object> to_things(const object_list_t& message);

/// Collects the chunks of the newest version of one kind.
template <class Message, class Thing>
class ListAssembler {
 public:
  /// @return true when this chunk completes a version; take it from things(). Older versions are
  /// passed over.
  bool add(const Message& message) {
    if (message.nchunks < 1 || message.nchunks > 10000 || message.chunk < 0 ||
        message.chunk >= message.nchunks)
      throw BadMessage("chunk " + std::to_string(message.chunk) + " of " +
                       std::to_string(message.nchunks));
    std::vector<Thing> content = to_things(message);
    const bool restarted = message.version == 1 && version_ > 1;
    if (message.version < version_ && !restarted) return false;
    if (message.version != version_ || message.nchunks != nchunks_) chunks_.clear();
    version_ = message.version;
    nchunks_ = message.nchunks;
    utime_ = message.utime;
    chunks_[message.chunk] = std::move(content);
    if (static_cast<int>(chunks_.size()) < nchunks_) return false;
    things_.clear();
    for (auto& [number, chunk] : chunks_) things_.insert(things_.end(), chunk.begin(), chunk.end());
    chunks_.clear();
    return true;
  }
  /// The newest complete list.
  const std::vector<Thing>& things() const { return things_; }
  std::int64_t version() const { return version_; }
  std::int64_t utime() const { return utime_; }

 private:
  std::map<int, std::vector<Thing>> chunks_;
  std::vector<Thing> things_;
  std::int64_t version_ = 0, utime_ = 0;
  int nchunks_ = 0;
};

/// A consumer's copy of the semantic map.
class SemanticMirror {
 public:
  /// Subscribes to the four lists.
  explicit SemanticMirror(Bus& bus);
  /// Called after any list was renewed.
  std::function<void()> on_change;
  Semantics semantics() const {
    return {walls_.things(), rooms_.things(), doors_.things(), objects_.things()};
  }

 private:
  ListAssembler<wall_list_t, Wall> walls_;
  ListAssembler<room_list_t, Room> rooms_;
  ListAssembler<door_list_t, Door> doors_;
  ListAssembler<object_list_t, Object> objects_;
};

}  // namespace modslam
