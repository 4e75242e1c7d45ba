# Hosts every module; each stands in its own library and is made by its factory (common/bus/modules.hpp).
target_link_libraries(modslam-offline PRIVATE module_scan_matcher module_graph_optimizer module_yardstick
  module_loop_detector module_map_builder module_semantic_classifier)
