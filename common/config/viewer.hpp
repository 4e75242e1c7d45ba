// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "common/config/visitor.hpp"

namespace modslam {

/// The web page that shows a live run.
struct ViewerConfig {
  static constexpr const char* kTable = "viewer";
  std::string host = "127.0.0.1";
  std::int64_t port = 8080;
  double rate_hz = 10.0;
  std::int64_t history_mb = 16;

  void visit(ConfigVisitor& v) {
    v.text("host", host,
           "Address the page is served on. Any but 127.0.0.1 opens it to others and needs a token "
           "in MODSLAM_TOKEN.");
    v.integer("port", port, 0, 65535, "", "Port of the page; 0: any free one.");
    v.number("rate_hz", rate_hz, 1.0, 30.0, "Hz",
             "How often a moving thing is sent to a page at most.");
    v.integer("history_mb", history_mb, 1, 2000, "MB",
              "Memory for the run's past, taken at the start; a longer run is kept whole, in larger steps.");
  }
};

}  // namespace modslam
