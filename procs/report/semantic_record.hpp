// SPDX-License-Identifier: BSD-3-Clause
/// @file The semantic map as a recorded run left it: the newest version of each list that is whole.
#pragma once
#include <map>
#include <modslam/door_list_t.hpp>
#include <modslam/object_list_t.hpp>
#include <modslam/place_list_t.hpp>
#include <modslam/room_list_t.hpp>
#include <modslam/wall_list_t.hpp>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/graph/types.hpp"
#include "common/semantics/types.hpp"

namespace modslam::report {

/// A chunk's items as they are kept.
template <class ListMessage, class Item, std::vector<Item> ListMessage::*kItems>
struct MemberItems {
  static std::vector<Item> of(const ListMessage& message) { return message.*kItems; }
};
struct PlaceItems {
  static std::vector<Place> of(const place_list_t& message);
};

/// Collects the chunks of one list; a version counts when all its chunks are there.
template <class ListMessage, class Item, class Items>
class ListRecord {
 public:
  void take(const ListMessage& message) {
    if (message.nchunks < 1 || message.nchunks > 100000 || message.chunk < 0 ||
        message.chunk >= message.nchunks)
      throw BadMessage("chunk " + std::to_string(message.chunk) + " of " +
                       std::to_string(message.nchunks));
    auto& parts = parts_[message.version];
    parts[message.chunk] = Items::of(message);
    if (static_cast<int>(parts.size()) < message.nchunks) return;
    items_.clear();
    for (const auto& [chunk, part] : parts) items_.insert(items_.end(), part.begin(), part.end());
    version_ = message.version;
    parts_.clear();
  }
  const std::vector<Item>& items() const { return items_; }
  std::int64_t version() const { return version_; }

 private:
  std::map<std::int64_t, std::map<int, std::vector<Item>>> parts_;
  std::vector<Item> items_;
  std::int64_t version_ = 0;
};

struct SemanticRecord {
  ListRecord<wall_list_t, wall_t, MemberItems<wall_list_t, wall_t, &wall_list_t::walls>> walls;
  ListRecord<room_list_t, room_t, MemberItems<room_list_t, room_t, &room_list_t::rooms>> rooms;
  ListRecord<door_list_t, door_t, MemberItems<door_list_t, door_t, &door_list_t::doors>> doors;
  ListRecord<object_list_t, object_t, MemberItems<object_list_t, object_t, &object_list_t::objects>>
      objects;
  ListRecord<place_list_t, Place, PlaceItems> places;
};

/// The record as one map; places stand where their nodes stand in the end, those without are left
/// out.
SemanticLayers layers_of(const SemanticRecord& record, const std::map<NodeId, Pose2>& nodes);

/// Words for enumerations in messages, e.g. "corridor", "open".
const char* room_type_name(int type);
const char* door_state_name(int state);

}  // namespace modslam::report
