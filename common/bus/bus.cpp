// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/bus.hpp"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <new>
#include <thread>
#include <utility>

namespace modslam {

struct Transport::Sink {
  RawHandler on_bytes;
  Transport* transport;

  // Exceptions must not cross LCM's C frames: version 1.3.1 aborts on its next call.
  static void receive(const lcm::ReceiveBuffer* buffer, const std::string& channel, Sink* self) {
    try {
      self->on_bytes(channel, buffer->data, static_cast<int>(buffer->data_size));
    } catch (...) {
      if (!self->transport->error_) self->transport->error_ = std::current_exception();
    }
  }
};

namespace {

/// Whether somebody listens at tcpq://host:port. LCM 1.3.1 itself aborts in its first wait when nobody does.
bool hub_answers(const std::string& url) {
  const std::string place = url.substr(std::strlen("tcpq://"), url.find('?') - std::strlen("tcpq://"));
  const auto colon = place.rfind(':');
  addrinfo wanted{}, *found = nullptr;
  wanted.ai_family = AF_INET;
  wanted.ai_socktype = SOCK_STREAM;
  const std::string host = place.substr(0, colon), port = colon == std::string::npos ? "7700" : place.substr(colon + 1);
  if (getaddrinfo(host.empty() ? "127.0.0.1" : host.c_str(), port.c_str(), &wanted, &found) != 0) return false;
  const int caller = socket(found->ai_family, found->ai_socktype, 0);
  const bool answers = connect(caller, found->ai_addr, found->ai_addrlen) == 0;
  close(caller);
  freeaddrinfo(found);
  return answers;
}

}  // namespace

Transport::Transport(const std::string& url) {
  const bool hub = lossless_ = url.rfind("tcpq://", 0) == 0;
  for (int tries = 180; hub && !hub_answers(url); --tries) {
    if (tries == 0) throw std::runtime_error("LCM cannot open '" + url + "': is the hub running?");
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  lcm_ = std::make_unique<lcm::LCM>(url);
  if (!lcm_->good())
    throw std::runtime_error("LCM cannot open '" + url + "': is there a multicast route? Try: ip route add 224.0.0.0/4 dev lo");
  const int at_once = 1;  // else a small message waits 40 ms for the answer to the one before
  if (hub) setsockopt(lcm_->getFileno(), IPPROTO_TCP, TCP_NODELAY, &at_once, sizeof at_once);
}

Transport::~Transport() = default;

bool Transport::poll(int timeout_ms) {
  errno = 0;
  const int status = lcm_->handleTimeout(timeout_ms);
  const bool interrupted = status < 0 && errno == EINTR;  // a signal came: the connection is well
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
  if (status < 0 && !interrupted) throw std::runtime_error("the LCM connection has failed");
  return status > 0;
}

void Transport::publish(const std::string& channel, const void* bytes, int size) {
  if (lcm_->publish(channel, bytes, static_cast<unsigned>(size)) != 0)
    throw std::runtime_error("LCM cannot publish on " + channel);
}

void Transport::subscribe(const std::string& channel, RawHandler on_bytes) {
  sinks_.push_back(std::make_unique<Sink>(Sink{std::move(on_bytes), this}));
  lcm::Subscription* subscription =
      lcm_->subscribeFunction(channel, &Sink::receive, sinks_.back().get());
  // After a failed self test 1.3.1 hands out an empty subscription that crashes when it is touched;
  // preflight() rules that out before anybody subscribes.
  if (subscription) subscription->setQueueCapacity(0);  // 0 = no bound; the default drops the newest
}

void Bus::publish_bytes(const std::string& channel, const void* bytes, int size) {
  ++outputs_[channel].received;
  transport_.publish(channel, bytes, size);
  if (on_published) on_published(channel, bytes, size);
}

void Bus::pass_on(const std::string& channel, const void* bytes, int size) {
  for (const auto& [name, handler] : handlers_)
    if (name == channel) handler(channel, bytes, size);
  if (on_any_) on_any_(channel, bytes, size);
}

void Bus::deliver(const std::string& channel, const void* bytes, int size) {
  delivered_.emplace(channel, std::string(static_cast<const char*>(bytes), static_cast<std::size_t>(size)));
  note_past(channel, bytes, size);
  pass_on(channel, bytes, size);
}

bool Bus::is_echo(const std::string& channel, const void* bytes, int size) {
  if (delivered_.empty()) return false;
  const auto found = delivered_.find({channel, std::string(static_cast<const char*>(bytes), static_cast<std::size_t>(size))});
  if (found == delivered_.end()) return false;
  delivered_.erase(found);
  return true;
}

void Bus::receive(const std::string& channel, const std::function<void()>& decode_and_handle) {
  ChannelCount& count = inputs_[channel];
  const auto refuse = [&](const std::string& why) {
    ++count.bad;
    if (on_bad) on_bad(channel, why);
  };
  try {
    if (around_handler)
      around_handler(decode_and_handle);
    else
      decode_and_handle();
  } catch (const BadMessage& bad) {
    refuse(bad.what());
  } catch (const std::length_error&) {  // a wild array length, thrown inside decode
    refuse("an array length in it is impossible");
  } catch (const std::bad_alloc&) {
    refuse("an array length in it is larger than memory");
  }
}

}  // namespace modslam
