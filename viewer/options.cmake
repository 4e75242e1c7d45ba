# The viewer alone needs civetweb, and carries its page inside the program.
find_library(CIVETWEB civetweb REQUIRED)
file(GLOB web_files CONFIGURE_DEPENDS ${directory}/web/*)
set(embedded ${CMAKE_BINARY_DIR}/viewer/web_files.cpp)
add_custom_command(OUTPUT ${embedded}
  COMMAND ${CMAKE_COMMAND} "-DFILES=${web_files}" -DOUT=${embedded} -P ${directory}/embed.cmake
  DEPENDS ${web_files} ${directory}/embed.cmake VERBATIM)
target_sources(module_viewer PRIVATE ${embedded})
target_link_libraries(module_viewer PUBLIC ${CIVETWEB})
