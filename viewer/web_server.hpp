// SPDX-License-Identifier: BSD-3-Clause
/// @file The page and its WebSocket on 127.0.0.1, by civetweb. The only place that knows threads
/// and sockets.
#pragma once
#include <atomic>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "viewer/hub.hpp"

struct mg_connection;
struct mg_context;

namespace modslam {

/// A file of viewer/web, embedded when the program was built.
struct WebFile {
  const char* path;  ///< "/app.js"
  const char* type;  ///< "text/javascript; charset=utf-8"
  std::string_view bytes;
};
const std::vector<WebFile>& web_files();

/// Whether a WebSocket request may be answered: it was sent to a loopback name (so no foreign name
/// was rebound to this machine) and, when a browser says where it comes from, it comes from that
/// very address.
/// @param host    header Host, e.g. "127.0.0.1:8080"; with port forwarding the port is the
/// forwarded one.
/// @param origin  header Origin, e.g. "http://127.0.0.1:8080"; empty: not from a web page.
bool is_own_page(const std::string& host, const std::string& origin);

/// Serves `files` at their paths and the streams of `hub` at /ws until it is destroyed.
class WebServer {
 public:
  static constexpr int kMaxPages =
      12;  ///< each holds one thread of the server; the next one gets a 503

  /// @throws std::runtime_error when the port is taken or not allowed; the text names it.
  WebServer(int port, Hub& hub, const std::vector<WebFile>& files);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  int port() const { return port_; }

 private:
  struct Page;
  static int answer(mg_connection* connection, void* self);
  static int admit(const mg_connection* connection, void* self);
  static void open(mg_connection* connection, void* self);
  static int hear(mg_connection* connection, int bits, char* bytes, std::size_t size, void* self);
  static void close(const mg_connection* connection, void* self);

  Hub& hub_;
  const std::vector<WebFile>& files_;
  std::atomic<int> pages_{0};
  mg_context* context_ = nullptr;
  int port_ = 0;
};

}  // namespace modslam
