// SPDX-License-Identifier: BSD-3-Clause
/// @file What a process missed between its death and its new life, out of the run's log.
///
/// The process has subscribed already and then speaks; all that stands in the log before that word and after its last handled
/// message was missed (or waits in its queue too, and is dropped there).
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "common/bus/log.hpp"
#include "common/bus/module.hpp"

namespace modslam {

struct Missed {
  std::vector<LogEvent> events;  ///< in order
  bool to_the_end = false;       ///< false: the log does not reach up to now; is the recorder well?
};

/// Calls `speak`, which publishes a STATUS of process `name` with `pid`, and waits until that stands in the log. A recorder that was
/// killed too may be back within `patience_ms`: it is called again, and what has come since the first time is left to the queue.
Missed read_missed(const std::string& run_log, const Resumption& resumption, const std::string& name, int pid, int patience_ms,
                   const std::function<void()>& speak);

}  // namespace modslam
