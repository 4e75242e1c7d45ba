# Hosts the simulated world and its sensors; each is made by its factory (common/bus/modules.hpp).
target_link_libraries(module_simulate PUBLIC module_simulator module_laser module_odometry module_ins)
