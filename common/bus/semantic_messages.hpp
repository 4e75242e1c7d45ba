// SPDX-License-Identifier: BSD-3-Clause
/// @file The semantic map as messages: whole lists in chunks that stay below 60 kB.
#pragma once
#include <modslam/door_list_t.hpp>
#include <modslam/object_list_t.hpp>
#include <modslam/place_list_t.hpp>
#include <modslam/room_list_t.hpp>
#include <modslam/wall_list_t.hpp>
#include <vector>

#include "common/semantics/types.hpp"

namespace modslam {

Wall from_message(const wall_t& message);
Door from_message(const door_t& message);
Room from_message(const room_t& message);
Object from_message(const object_t& message);
wall_t to_message(const Wall& wall);
door_t to_message(const Door& door);
room_t to_message(const Room& room);
room_event_t to_message(const RoomEvent& event);
object_t to_message(const Object& object, std::int64_t utime);

/// Node ids count on from chunk to chunk. An empty list is one empty chunk.
std::vector<place_list_t> to_place_chunks(const std::vector<Place>& places, std::int64_t utime, std::int64_t version);
/// Places of one chunk; p is left to who knows the nodes. @throws BadMessage on an unknown kind or an impossible node or confidence.
std::vector<Place> from_message(const place_list_t& message);

/// Splits a list into chunks of at most `max_bytes`; an empty list is one empty chunk.
/// ListMessage: e.g. wall_list_t; set_items(message, items) puts a piece in.
template <class ListMessage, class Item, class SetItems>
std::vector<ListMessage> to_chunks(const std::vector<Item>& items, std::int64_t utime, std::int64_t version, SetItems set_items,
                                   int max_bytes = 50000) {
  std::vector<std::vector<Item>> pieces(1);
  int bytes = 0;
  for (const Item& item : items) {
    const int size = item.getEncodedSize();
    if (bytes + size > max_bytes && !pieces.back().empty()) {
      pieces.emplace_back();
      bytes = 0;
    }
    pieces.back().push_back(item);
    bytes += size;
  }
  std::vector<ListMessage> chunks;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    ListMessage message{};
    message.utime = utime;
    message.version = version;
    message.chunk = static_cast<std::int32_t>(k);
    message.nchunks = static_cast<std::int32_t>(pieces.size());
    set_items(message, pieces[k]);
    chunks.push_back(message);
  }
  return chunks;
}

}  // namespace modslam
