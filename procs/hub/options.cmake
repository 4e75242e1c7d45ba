# modslam-hub.jar: LCM's TCP hub on loopback only, for replays that are faster than UDP can carry.
find_program(JAVAC javac)
find_program(JAR jar)
find_file(LCM_JAR lcm.jar PATHS /usr/share/java /usr/local/share/java NO_DEFAULT_PATH)
if(JAVAC AND JAR AND LCM_JAR)
  set(hub ${CMAKE_BINARY_DIR}/hub)
  add_custom_command(OUTPUT ${CMAKE_BINARY_DIR}/modslam-hub.jar
    COMMAND ${CMAKE_COMMAND} -E make_directory ${hub}
    COMMAND ${JAVAC} -nowarn -d ${hub} -cp ${LCM_JAR} ${directory}/LoopbackHub.java
    COMMAND ${JAR} cf ${CMAKE_BINARY_DIR}/modslam-hub.jar -C ${hub} .
    DEPENDS ${directory}/LoopbackHub.java COMMENT "Building modslam-hub.jar" VERBATIM)
  add_custom_target(modslam-hub ALL DEPENDS ${CMAKE_BINARY_DIR}/modslam-hub.jar)
else()
  message(STATUS "No JDK or no lcm.jar: no replay faster than UDP (default-jdk-headless, liblcm-java)")
endif()
