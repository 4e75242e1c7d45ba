// SPDX-License-Identifier: BSD-3-Clause
/// @file The modules of the system. Each is defined in procs/<its name>; a host links the ones it calls.
#pragma once
#include "common/bus/module.hpp"

namespace modslam {

std::unique_ptr<Module> make_simulator(Bus&, const SystemConfig&);
std::unique_ptr<Module> make_laser(Bus&, const SystemConfig&);
std::unique_ptr<Module> make_odometry(Bus&, const SystemConfig&);
std::unique_ptr<Module> make_ins(Bus&, const SystemConfig&);
std::unique_ptr<Module> make_scan_matcher(Bus&, const SystemConfig&);
std::unique_ptr<Module> make_graph_optimizer(Bus&, const SystemConfig&);
std::unique_ptr<Module> make_localizer(Bus&, const SystemConfig&);
std::unique_ptr<Module> make_yardstick(Bus&, const SystemConfig&);
std::unique_ptr<Module> make_loop_detector(Bus&, const SystemConfig&);
std::unique_ptr<Module> make_map_builder(Bus&, const SystemConfig&);
std::unique_ptr<Module> make_semantic_classifier(Bus&, const SystemConfig&);
std::unique_ptr<Module> make_recorder(Bus&, const SystemConfig&);
std::unique_ptr<Module> make_player(Bus&, const SystemConfig&);
std::unique_ptr<Module> make_viewer(Bus&, const SystemConfig&);

}  // namespace modslam
