// SPDX-License-Identifier: BSD-3-Clause
/// @file Questions about rooms and ways, answered from a topology.
#pragma once
#include <modslam/answer_t.hpp>
#include <modslam/query_t.hpp>

#include "common/topology/topology.hpp"

namespace modslam {

/// Never fails: what cannot be answered says why. Of a map that does not fit into one message the first rooms and doors are told.
answer_t answer(const Topology& topology, const query_t& query, std::int64_t utime);

}  // namespace modslam
