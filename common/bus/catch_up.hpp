// SPDX-License-Identifier: BSD-3-Clause
/// @file What a process missed between its death and its new life, out of the run's log.
///
/// The process has subscribed already and then spoken once; all that stands in the log before that word and after its last handled
/// message was missed (or waits in its queue too, and is dropped there).
#pragma once
#include <string>
#include <vector>

#include "common/bus/log.hpp"
#include "common/bus/module.hpp"

namespace modslam {

struct Missed {
  std::vector<LogEvent> events;  ///< in order
  bool to_the_end = false;       ///< false: the log does not reach up to now; is the recorder well?
};

/// Waits up to `patience_ms` until the STATUS that process `name` with `pid` has published stands in the log.
Missed read_missed(const std::string& run_log, const Resumption& resumption, const std::string& name, int pid, int patience_ms);

}  // namespace modslam
