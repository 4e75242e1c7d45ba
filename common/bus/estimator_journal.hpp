// SPDX-License-Identifier: BSD-3-Clause
/// @file The estimator's journal: NODE and GRAPH as they are published, LOOP as it came, and where the estimator stood.
///
/// An ESTIMATOR_STATE completes what was written before it: records behind the last one were not published yet, and are left out when
/// the journal is read. Numbers that come twice (a life that ended between a record and its state) mean the later one.
#pragma once
#include <modslam/estimator_state_t.hpp>
#include <modslam/graph_node_t.hpp>
#include <optional>

#include "common/bus/journal.hpp"
#include "common/graph/estimator.hpp"

namespace modslam {

inline constexpr const char* kEstimatorState = "ESTIMATOR_STATE";
inline constexpr const char* kEstimatorAnchor = "ESTIMATOR_ANCHOR";  ///< journals of older versions have none
inline constexpr const char* kLoopRecord = "LOOP";  ///< that was handled

struct EstimatorPast {
  estimator_state_t state{};
  EstimatorMemory memory;
  std::int32_t unrecognised = 0;  ///< scans in a row
  std::vector<graph_node_t> nodes;
  std::vector<LoopProposal> loops;  ///< all that were handled
};

/// @return nothing when the records hold no state, or too little of a graph to go on from; `trouble` then says what is wrong.
std::optional<EstimatorPast> read_estimator_journal(Journal& journal, std::string& trouble);

}  // namespace modslam
