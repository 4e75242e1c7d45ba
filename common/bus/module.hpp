// SPDX-License-Identifier: BSD-3-Clause
/// @file A module reacts to messages. Its own process hosts it on the network; `offline` hosts all together.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace modslam {

class Bus;
struct SystemConfig;

/// What a module that goes on after it was killed has missed: everything on `channels` behind its last message. The host finds it in the
/// run's log.
struct Resumption {
  std::vector<std::string> channels;
  std::string last_channel;   ///< the one whose messages drive the module
  std::int64_t last_utime;    ///< [us] of the last message on it that was handled
  std::int64_t last_wall_us;  ///< [us] wall time of that
};

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

  /// Something when the module goes on where an earlier life of it was killed.
  virtual std::optional<Resumption> resumption() const { return std::nullopt; }

  /// False while it is known that messages are missing which can still come: the end of the input waits for them, for some seconds.
  virtual bool complete() const { return true; }

  /// What a person asks of this module alone, by COMMAND. @return false: it knows no such verb.
  virtual bool command(const std::string& verb) { (void)verb; return false; }

  /// The network lost a message on `channel` on its way to this module.
  virtual void missed(const std::string& channel) { (void)channel; }

  /// One line for people about what the module is doing.
  virtual std::string words() const { return {}; }
};

/// Every process folder defines one of these; modules.hpp lists them.
using ModuleFactory = std::unique_ptr<Module> (*)(Bus&, const SystemConfig&);

}  // namespace modslam
