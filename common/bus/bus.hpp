// SPDX-License-Identifier: BSD-3-Clause
/// @file Typed publish and subscribe over raw LCM subscriptions: the only door between modules and LCM.
///
/// A Transport owns one LCM connection (a network or the in-process queue); each module talks through
/// its own Bus on it, which counts what it received, refused and missed. Every decode is guarded: what
/// cannot be decoded or is refused by a handler (BadMessage) is counted and dropped, never fatal. Any
/// other exception of a handler is kept and rethrown by poll() once no C frame of LCM is on the stack.
#pragma once
#include <cstdint>
#include <exception>
#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

namespace modslam {

/// Thrown by a handler or a conversion to refuse a message: counted as bad, said once a second, dropped.
struct BadMessage : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct ChannelCount {
  std::int64_t received = 0, bad = 0;
  std::int64_t gaps = 0;  ///< that a module saw in the numbers of a stream
  std::int64_t lost = 0;  ///< that the sender counted and we did not (LossMeter)
};

/// One LCM connection. Not thread-safe.
class Transport {
 public:
  using RawHandler = std::function<void(const std::string& channel, const void* bytes, int size)>;

  /// Waits up to 18 s for a TCP hub that is just being started (Java, on a machine that may be busy). @throws std::runtime_error when LCM cannot open the url.
  explicit Transport(const std::string& url);
  ~Transport();
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;

  /// Handles one message. @return true if there was one within timeout_ms.
  /// @throws what a handler threw, and std::runtime_error when the connection has failed.
  bool poll(int timeout_ms);
  void publish(const std::string& channel, const void* bytes, int size);
  /// Whether it delivers everything in order: a hub does, multicast does not.
  bool is_lossless() const { return lossless_; }
  /// `channel` is a regular expression, as LCM has it. Queue without bound: the handler must be quick.
  void subscribe(const std::string& channel, RawHandler on_bytes);

 private:
  struct Sink;
  std::unique_ptr<lcm::LCM> lcm_;
  std::vector<std::unique_ptr<Sink>> sinks_;
  std::exception_ptr error_;
  bool lossless_ = false;
};

/// A module's view of the transport.
class Bus {
 public:
  /// Stands before the handlers: may keep a message back and pass it on later, with Bus::pass_on.
  class Gate {
   public:
    virtual ~Gate() = default;
    /// @return true when the gate keeps it.
    virtual bool take(const std::string& channel, const void* bytes, int size) = 0;
    /// A message that came by another way, out of a log.
    virtual void note(const std::string& channel, const void* bytes, int size) = 0;
    /// Whether messages on this channel are kept back or asked for.
    virtual bool awaits(const std::string& channel) const = 0;
    /// The newest message on this channel may have been lost.
    virtual void suspect(const std::string& channel) = 0;
  };
  void set_gate(Gate* gate) { gate_ = gate; }
  bool awaits(const std::string& channel) const { return gate_ && gate_->awaits(channel); }
  void suspect(const std::string& channel) {
    if (gate_) gate_->suspect(channel);
  }
  /// What somebody else has heard still comes: a message may overtake another speaker's, but none is lost.
  bool is_lossless() const { return transport_.is_lossless(); }
  void note_past(const std::string& channel, const void* bytes, int size) {
    if (gate_) gate_->note(channel, bytes, size);
  }
  void uncount(const std::string& channel) { --inputs_[channel].received; }
  void pass_on(const std::string& channel, const void* bytes, int size);

  Bus(Transport& transport, std::string process_name)
      : transport_(transport), name_(std::move(process_name)) {}
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  template <class Message>
  void subscribe(const std::string& channel, std::function<void(const Message&)> on_message) {
    inputs_[channel];
    const Transport::RawHandler handler = [this, on_message](const std::string& name, const void* bytes, int size) {
      receive(name, [&] {
        Message message{};
        if (message.decode(bytes, 0, size) != size) throw BadMessage("cannot be decoded");
        on_message(message);
      });
    };
    handlers_.emplace_back(channel, handler);
    transport_.subscribe(channel, [this, handler](const std::string& name, const void* bytes, int size) {
      ++inputs_[name].received;
      if (is_echo(name, bytes, size) || (gate_ && gate_->take(name, bytes, size))) return;
      handler(name, bytes, size);
    });
  }

  /// Hands a message that this module missed to its handlers, as if it came now. When it does come after all, it is dropped.
  void deliver(const std::string& channel, const void* bytes, int size);
  void forget_delivered() { delivered_.clear(); }

  /// Every message on any channel, undecoded.
  void subscribe_bytes(Transport::RawHandler on_bytes) {
    on_any_ = on_bytes;
    transport_.subscribe(".*", [this, on_bytes](const std::string& name, const void* bytes, int size) {
      ++inputs_[name].received;
      if (!gate_ || !gate_->take(name, bytes, size)) on_bytes(name, bytes, size);
    });
  }

  template <class Message>
  void publish(const std::string& channel, const Message& message) {
    const int size = message.getEncodedSize();
    buffer_.resize(static_cast<std::size_t>(size));
    if (message.encode(buffer_.data(), 0, size) != size)
      throw std::logic_error(name_ + ": cannot encode a message for " + channel);
    publish_bytes(channel, buffer_.data(), size);
  }
  void publish_bytes(const std::string& channel, const void* bytes, int size);

  /// Says before the first message on a channel that there will be some.
  void publishes(const std::string& channel) { outputs_[channel]; }
  /// Called with each message that was published.
  Transport::RawHandler on_published;

  /// A module tells that `missing` messages of a numbered stream did not arrive.
  void count_gap(const std::string& channel, std::int64_t missing) { inputs_[channel].gaps += missing; }

  bool hears(const std::string& channel) const { return on_any_ || inputs_.count(channel) > 0; }
  /// What LossMeter found.
  void set_lost(const std::string& channel, std::int64_t lost) { inputs_[channel].lost = lost; }

  /// Newest message time seen or published [us]; 0 before the first. Stamps may step back, this does not.
  std::int64_t utime() const { return utime_; }
  void saw_utime(std::int64_t utime) { utime_ = utime > utime_ ? utime : utime_; }

  const std::string& name() const { return name_; }
  const std::map<std::string, ChannelCount>& inputs() const { return inputs_; }
  const std::map<std::string, ChannelCount>& outputs() const { return outputs_; }

  /// Called for each refused message with its channel and the reason.
  std::function<void(const std::string& channel, const std::string& why)> on_bad;
  /// Called after each handled message with the time it took; set by the host that may read clocks.
  std::function<void(const std::function<void()>& handle)> around_handler;

 private:
  void receive(const std::string& channel, const std::function<void()>& decode_and_handle);
  bool is_echo(const std::string& channel, const void* bytes, int size);

  Transport& transport_;
  std::string name_;
  std::map<std::string, ChannelCount> inputs_, outputs_;
  std::vector<std::pair<std::string, Transport::RawHandler>> handlers_;
  Transport::RawHandler on_any_;
  Gate* gate_ = nullptr;
  std::multiset<std::pair<std::string, std::string>> delivered_;  ///< channel and bytes
  std::vector<std::uint8_t> buffer_;
  std::int64_t utime_ = 0;
};

}  // namespace modslam
