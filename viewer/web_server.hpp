// SPDX-License-Identifier: BSD-3-Clause
/// @file The page, its WebSocket and the run's past, by civetweb. The only place that knows threads
/// and sockets.
#pragma once
#include <atomic>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "viewer/gate.hpp"
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

/// Serves `files` at their paths, the streams of `hub` at /ws and its past at /past?utime=N until
/// it is destroyed. Its threads run at low priority: whatever is asked of them, mapping goes first.
class WebServer {
 public:
  static constexpr int kMaxPages =
      12;  ///< each holds one thread of the server; the next one gets a 503

  /// @throws std::runtime_error when the port is taken or not allowed; the text names it.
  WebServer(const std::string& host, int port, Gate gate, Hub& hub, Wishes& wishes,
            const std::vector<WebFile>& files);
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

  bool admits(const mg_connection* connection) const;
  int send_past(mg_connection* connection, const std::string& query);
  bool send_file(mg_connection* connection, const std::string& path, bool with_body) const;

  Gate gate_;
  Hub& hub_;
  Wishes& wishes_;
  const std::vector<WebFile>& files_;
  RateLimit requests_{100, 200}, pasts_{20, 20};
  std::atomic<int> pages_{0};
  mg_context* context_ = nullptr;
  int port_ = 0;
};

}  // namespace modslam
