// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "common/config/visitor.hpp"

namespace modslam {

/// The web page that shows a live run.
struct ViewerConfig {
  static constexpr const char* kTable = "viewer";
  std::int64_t port = 8080;
  double rate_hz = 10.0;

  void visit(ConfigVisitor& v) {
    v.integer("port", port, 0, 65535, "", "Port of the page on 127.0.0.1; 0: any free one.");
    v.number("rate_hz", rate_hz, 1.0, 30.0, "Hz",
             "How often a moving thing is sent to a page at most.");
  }
};

}  // namespace modslam
