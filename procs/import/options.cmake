# Reading rawlogs needs MRPT; no other process pays for it.
find_package(mrpt-obs REQUIRED)
target_link_libraries(module_import PRIVATE mrpt::obs -Wl,--as-needed)
