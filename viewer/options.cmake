# The viewer alone needs civetweb, and carries its page inside the program, dygraphs (plots; MIT licence) among it.
find_library(CIVETWEB civetweb REQUIRED)
find_path(DYGRAPHS dygraph.min.js PATHS /usr/share/javascript/dygraphs REQUIRED)
file(GLOB web_files CONFIGURE_DEPENDS ${directory}/web/*)
list(APPEND web_files ${DYGRAPHS}/dygraph.min.js ${DYGRAPHS}/dygraph.min.css)
set(embedded ${CMAKE_BINARY_DIR}/viewer/web_files.cpp)
add_custom_command(OUTPUT ${embedded}
  COMMAND ${CMAKE_COMMAND} "-DFILES=${web_files}" -DOUT=${embedded} -P ${directory}/embed.cmake
  DEPENDS ${web_files} ${directory}/embed.cmake VERBATIM)
target_sources(module_viewer PRIVATE ${embedded})
target_link_libraries(module_viewer PUBLIC ${CIVETWEB})
