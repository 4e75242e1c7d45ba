// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/web_server.hpp"

#include <civetweb.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <thread>

namespace modslam {
namespace {

constexpr auto kWakeUp = std::chrono::milliseconds(200);
constexpr auto kTooManyPause = std::chrono::milliseconds(50);
constexpr int kNice = 10;

/// Only what this server itself sends may run or load on the page; the hash is of the one inline
/// style by which dygraphs measures an em.
constexpr const char* kSafetyHeaders =
    "Content-Security-Policy: default-src 'self'; connect-src 'self'; img-src 'self' data:; "
    "style-src 'self' 'unsafe-hashes' 'sha256-MJyOH6fkfzWPCLv2CfAAYjOtxkqoLBYZsmiMyy1D4sc='; "
    "frame-ancestors 'none'\r\n"
    "X-Content-Type-Options: nosniff\r\n"
    "Referrer-Policy: no-referrer\r\n"
    "Cache-Control: no-cache\r\n";

std::string header(const mg_connection* connection, const char* name) {
  const char* value = mg_get_header(connection, name);
  return value ? value : "";
}

int refuse(const mg_connection* connection, int status, const char* why) {
  // civetweb hands a const connection to the one callback that may answer on it.
  mg_send_http_error(const_cast<mg_connection*>(connection), status, "%s", why);
  return status;
}

/// civetweb's threads, and those they start, step back behind the mapping processes.
void* step_back(const mg_context*, int) {
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNice);
  return nullptr;
}

void append_length(std::string& bytes, std::uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8)
    bytes.push_back(static_cast<char>((value >> shift) & 0xff));
}

}  // namespace

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

WebServer::WebServer(const std::string& host, int port, Gate gate, Hub& hub, Wishes& wishes,
                     const std::vector<WebFile>& files)
    : gate_(std::move(gate)), hub_(hub), wishes_(wishes), files_(files) {
  const std::string address = host + ":" + std::to_string(port);
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
  mg_callbacks callbacks{};
  callbacks.init_thread = step_back;
  context_ = mg_start(&callbacks, nullptr, options);
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

bool WebServer::admits(const mg_connection* connection) const {
  const mg_request_info* request = mg_get_request_info(connection);
  return gate_.admits(header(connection, "Host"), header(connection, "Origin"),
                      request->query_string ? request->query_string : "");
}

int WebServer::answer(mg_connection* connection, void* self) {
  auto* server = static_cast<WebServer*>(self);
  if (!server->requests_.take()) {
    std::this_thread::sleep_for(kTooManyPause);  // holds the asker back, not the run
    return refuse(connection, 429, "too many requests");
  }
  const mg_request_info* request = mg_get_request_info(connection);
  const std::string method = request->request_method, path = request->local_uri;
  if (method != "GET" && method != "HEAD") return refuse(connection, 405, "only GET and HEAD");
  if (path == "/past") {
    if (!server->admits(connection)) return refuse(connection, 403, "only the viewer's own page");
    return server->send_past(connection, request->query_string ? request->query_string : "");
  }
  if (server->send_file(connection, path == "/" ? "/index.html" : path, method == "GET"))
    return 200;
  return refuse(connection, 404, "no such page");
}

bool WebServer::send_file(mg_connection* connection, const std::string& path,
                          bool with_body) const {
  for (const WebFile& file : files_) {
    if (path != file.path) continue;
    mg_printf(
        connection,
        "HTTP/1.1 200 OK\r\nContent-Type: %s\r\nContent-Length: %zu\r\n%sConnection: close\r\n\r\n",
        file.type, file.bytes.size(), kSafetyHeaders);
    if (with_body) mg_write(connection, file.bytes.data(), file.bytes.size());
    return true;
  }
  return false;
}

/// All frames of that time, each behind a byte (1: binary) and its length, 4 bytes little endian.
int WebServer::send_past(mg_connection* connection, const std::string& query) {
  const std::string utime = query_value(query, "utime").value_or("");
  char* end = nullptr;
  const std::int64_t wanted = std::strtoll(utime.c_str(), &end, 10);
  if (utime.empty() || *end != '\0') return refuse(connection, 400, "utime is no number");
  if (!pasts_.take()) {
    std::this_thread::sleep_for(kTooManyPause);
    return refuse(connection, 429, "too many requests");
  }
  std::string body;
  for (const FramePtr& frame : hub_.history().at(wanted)) {
    body.push_back(frame->binary ? 1 : 0);
    append_length(body, static_cast<std::uint32_t>(frame->bytes.size()));
    body += frame->bytes;
  }
  mg_printf(connection,
            "HTTP/1.1 200 OK\r\nContent-Type: application/octet-stream\r\nContent-Length: %zu\r\n"
            "%sConnection: close\r\n\r\n",
            body.size(), kSafetyHeaders);
  mg_write(connection, body.data(), body.size());
  return 200;
}

int WebServer::admit(const mg_connection* connection, void* self) {
  auto* server = static_cast<WebServer*>(self);
  if (!server->requests_.take()) return refuse(connection, 429, "too many requests"), 1;
  if (!server->admits(connection))
    return refuse(connection, 403, "only the viewer's own page may listen"), 1;
  if (server->pages_ >= kMaxPages) return refuse(connection, 503, "too many pages are open"), 1;
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

/// A page may wish something of a player; anything else but a sign of life ends the connection.
int WebServer::hear(mg_connection*, int bits, char* bytes, std::size_t size, void* self) {
  const int kind = bits & 0x0f;
  if (kind == MG_WEBSOCKET_OPCODE_TEXT)
    return size <= 16 && static_cast<WebServer*>(self)->wishes_.add({bytes, size});
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
