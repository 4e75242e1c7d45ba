// SPDX-License-Identifier: BSD-3-Clause
/// @file A module reacts to messages. Its own process hosts it on the network; `offline` hosts all together.
#pragma once
#include <cstdint>
#include <memory>
#include <string>

namespace modslam {

class Bus;
struct SystemConfig;

class Module {
 public:
  virtual ~Module() = default;

  /// The input has ended: settle everything that waits for more and publish the last state.
  virtual void finish() {}

  /// For modules that are paced by wall time (simulated worlds, drivers, viewer): called at least every 10 ms of a live run,
  /// with a steady clock. Modules that only react to messages leave it alone.
  virtual void tick(std::int64_t steady_us) { (void)steady_us; }

  /// For sources in a batch run: produce the next piece. @return false when there is no more.
  virtual bool step() { return false; }

  /// True when a source has nothing more to give (a simulated route has been driven).
  virtual bool ended() const { return false; }

  /// True when the module cannot do its work; then words() says why.
  virtual bool troubled() const { return false; }

  /// One line for people about what the module is doing.
  virtual std::string words() const { return {}; }
};

/// Every process folder defines one of these; modules.hpp lists them.
using ModuleFactory = std::unique_ptr<Module> (*)(Bus&, const SystemConfig&);

}  // namespace modslam
