# modslam-spy-views.jar: what lcm-spy draws on a double click. Needs what modslam-types.jar needs.
find_program(JAVAC javac)
find_program(JAR jar)
find_file(LCM_JAR lcm.jar PATHS /usr/share/java /usr/local/share/java NO_DEFAULT_PATH)
if(JAVAC AND JAR AND LCM_JAR)
  file(GLOB views CONFIGURE_DEPENDS ${directory}/views/modslam/spy/*.java)
  set(classes ${CMAKE_BINARY_DIR}/spy-views)
  add_custom_command(OUTPUT ${CMAKE_BINARY_DIR}/modslam-spy-views.jar
    COMMAND ${CMAKE_COMMAND} -E make_directory ${classes}
    COMMAND ${JAVAC} -d ${classes} -cp ${LCM_JAR}:${CMAKE_BINARY_DIR}/modslam-types.jar ${views}
    COMMAND ${JAR} cf ${CMAKE_BINARY_DIR}/modslam-spy-views.jar -C ${classes} .
    DEPENDS ${views} ${CMAKE_BINARY_DIR}/modslam-types.jar modslam_types_jar COMMENT "Building modslam-spy-views.jar for lcm-spy" VERBATIM)
  add_custom_target(modslam_spy_views ALL DEPENDS ${CMAKE_BINARY_DIR}/modslam-spy-views.jar)
endif()
