// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/modules.hpp"
#include "common/bus/process.hpp"

int main(int argc, char** argv) { return modslam::run_process(argc, argv, "localizer", modslam::make_localizer); }
