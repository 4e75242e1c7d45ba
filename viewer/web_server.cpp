// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/web_server.hpp"

#include <civetweb.h>

#include <stdexcept>
#include <thread>

namespace modslam {
namespace {

constexpr auto kWakeUp = std::chrono::milliseconds(200);

/// Only what this server itself sends may run or load on the page.
constexpr const char* kSafetyHeaders =
    "Content-Security-Policy: default-src 'self'; connect-src 'self'; img-src 'self' data:; "
    "frame-ancestors 'none'\r\n"
    "X-Content-Type-Options: nosniff\r\n"
    "Referrer-Policy: no-referrer\r\n"
    "Cache-Control: no-cache\r\n";

std::string header(const mg_connection* connection, const char* name) {
  const char* value = mg_get_header(connection, name);
  return value ? value : "";
}

void refuse(const mg_connection* connection, int status, const char* why) {
  // civetweb hands a const connection to the one callback that may answer on it.
  mg_send_http_error(const_cast<mg_connection*>(connection), status, "%s", why);
}

}  // namespace

bool is_own_page(const std::string& host, const std::string& origin) {
  const std::size_t colon = host.rfind(':');
  const bool has_port = colon != std::string::npos && host.find(']', colon) == std::string::npos;
  const std::string name = host.substr(0, has_port ? colon : host.size());
  const bool loopback = name == "127.0.0.1" || name == "localhost" || name == "[::1]";
  return loopback && (origin.empty() || origin == "http://" + host);
}

/// A connected page and the thread that empties its outbox.
struct WebServer::Page {
  std::shared_ptr<Outbox> outbox;
  std::thread sender;

  static void send(mg_connection* connection, Outbox& outbox) {
    while (!outbox.closed()) {
      const std::optional<FramePtr> frame = outbox.take(kWakeUp);
      if (!frame) continue;
      const std::string& bytes = (*frame)->bytes;
      const int kind = (*frame)->binary ? MG_WEBSOCKET_OPCODE_BINARY : MG_WEBSOCKET_OPCODE_TEXT;
      if (mg_websocket_write(connection, kind, bytes.data(), bytes.size()) <= 0) return;
    }
  }
};

WebServer::WebServer(int port, Hub& hub, const std::vector<WebFile>& files)
    : hub_(hub), files_(files) {
  const std::string address = "127.0.0.1:" + std::to_string(port);
  const std::string threads = std::to_string(kMaxPages + 4);
  const char* options[] = {"listening_ports",
                           address.c_str(),
                           "num_threads",
                           threads.c_str(),
                           "request_timeout_ms",
                           "5000",
                           "websocket_timeout_ms",
                           "10000",
                           "enable_websocket_ping_pong",
                           "yes",
                           nullptr};
  mg_init_library(0);
  context_ = mg_start(nullptr, nullptr, options);
  if (!context_) {
    mg_exit_library();
    throw std::runtime_error(
        "cannot listen on " + address +
        ": the port is taken (another viewer?) or not allowed; choose a free one with "
        "--set viewer.port=N");
  }
  mg_server_port bound{};
  mg_get_server_ports(context_, 1, &bound);
  port_ = bound.port;
  mg_set_request_handler(context_, "/", &WebServer::answer, this);
  mg_set_websocket_handler(context_, "/ws", &WebServer::admit, &WebServer::open, &WebServer::hear,
                           &WebServer::close, this);
}

WebServer::~WebServer() {
  mg_stop(context_);
  mg_exit_library();
}

int WebServer::answer(mg_connection* connection, void* self) {
  const mg_request_info* request = mg_get_request_info(connection);
  const std::string method = request->request_method;
  if (method != "GET" && method != "HEAD") {
    refuse(connection, 405, "only GET and HEAD");
    return 405;
  }
  std::string path = request->local_uri;
  if (path == "/") path = "/index.html";
  for (const WebFile& file : static_cast<WebServer*>(self)->files_) {
    if (path != file.path) continue;
    mg_printf(
        connection,
        "HTTP/1.1 200 OK\r\nContent-Type: %s\r\nContent-Length: %zu\r\n%sConnection: close\r\n\r\n",
        file.type, file.bytes.size(), kSafetyHeaders);
    if (method == "GET") mg_write(connection, file.bytes.data(), file.bytes.size());
    return 200;
  }
  refuse(connection, 404, "no such page");
  return 404;
}

int WebServer::admit(const mg_connection* connection, void* self) {
  if (!is_own_page(header(connection, "Host"), header(connection, "Origin"))) {
    refuse(connection, 403, "only the viewer's own page may listen");
    return 1;
  }
  if (static_cast<WebServer*>(self)->pages_ >= kMaxPages) {
    refuse(connection, 503, "too many pages are open");
    return 1;
  }
  return 0;
}

void WebServer::open(mg_connection* connection, void* self) {
  auto* server = static_cast<WebServer*>(self);
  ++server->pages_;
  auto* page = new Page{server->hub_.join(), {}};
  page->sender =
      std::thread([connection, outbox = page->outbox] { Page::send(connection, *outbox); });
  mg_set_user_connection_data(connection, page);
}

/// The page only listens: anything but a sign of life ends the connection.
int WebServer::hear(mg_connection*, int bits, char*, std::size_t, void*) {
  const int kind = bits & 0x0f;
  return kind == MG_WEBSOCKET_OPCODE_PING || kind == MG_WEBSOCKET_OPCODE_PONG;
}

void WebServer::close(const mg_connection* connection, void* self) {
  const std::unique_ptr<Page> page(static_cast<Page*>(mg_get_user_connection_data(connection)));
  if (!page) return;
  auto* server = static_cast<WebServer*>(self);
  server->hub_.leave(page->outbox);
  page->sender.join();
  --server->pages_;
}

}  // namespace modslam
