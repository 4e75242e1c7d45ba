// SPDX-License-Identifier: BSD-3-Clause
/// @file How many messages the network lost, exactly: every process says in STATUS how many it has sent, every listener knows how many came.
///
/// A STATUS stands in the listener's queue behind what its sender sent before it, so the difference is what was lost. Only for
/// channels that one process speaks on, and STATUS; a sender that was restarted is counted anew from its next STATUS.
#pragma once
#include <map>
#include <modslam/process_status_t.hpp>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"

namespace modslam {

class LossMeter {
 public:
  /// Takes in what a sender says and writes what was lost into `bus`. @return channels on which more was lost than at its last STATUS.
  std::vector<std::string> take(const process_status_t& status, Bus& bus);

 private:
  struct Sender {
    std::int32_t pid = 0;
    std::int64_t sent = 0, received = 0;  ///< when it was first heard
    std::int64_t lost = 0;                ///< since then
    std::int64_t lost_before = 0;         ///< of its earlier lives
    std::int64_t newest = -1;             ///< number of its newest STATUS
  };
  void take_statuses(const process_status_t& status, Bus& bus);

  std::map<std::string, Sender> by_channel_;
  std::map<std::string, Sender> statuses_;  ///< by process
};

}  // namespace modslam
