// SPDX-License-Identifier: BSD-3-Clause
/// viewer: what the bus says of the live run, as a web page on 127.0.0.1. Config: [viewer]. See
/// README.md.
#include "common/bus/modules.hpp"
#include "common/bus/process.hpp"

int main(int argc, char** argv) {
  return modslam::run_process(argc, argv, "viewer", modslam::make_viewer);
}
