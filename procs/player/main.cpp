// SPDX-License-Identifier: BSD-3-Clause
/// modslam-player: plays an LCM log on the bus; a person drives it from the page.
#include "common/bus/modules.hpp"
#include "common/bus/process.hpp"

int main(int argc, char** argv) { return modslam::run_process(argc, argv, "player", modslam::make_player); }
