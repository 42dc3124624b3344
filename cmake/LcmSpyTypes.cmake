# The message types as Java classes, for lcm-spy: java/active_lab_types.jar in the build folder. Built where
# Java's compiler and LCM's Java library (Debian: default-jdk-headless, liblcm-java) are installed.
find_package(Java QUIET COMPONENTS Development)
find_file(LCM_JAR lcm.jar PATHS /usr/share/java)
if(NOT Java_FOUND OR NOT LCM_JAR)
  message(STATUS "No types for lcm-spy: Java's compiler or lcm.jar is not installed")
  return()
endif()

# lcm_spy_types(file.lcm...)
function(lcm_spy_types)
  set(folder "${CMAKE_BINARY_DIR}/java")
  set(jar "${folder}/active_lab_types.jar")
  set(classes)
  foreach(definition IN LISTS ARGN)
    cmake_path(GET definition STEM name)
    list(APPEND classes "${folder}/source/lab/${name}.java")
  endforeach()
  add_custom_command(OUTPUT "${jar}"
    COMMAND "${CMAKE_COMMAND}" -E rm -rf "${folder}/source" "${folder}/classes"
    COMMAND "${CMAKE_COMMAND}" -E make_directory "${folder}/source" "${folder}/classes"
    COMMAND "${LCM_GEN}" --java --jpath "${folder}/source" ${ARGN}
    COMMAND "${Java_JAVAC_EXECUTABLE}" -nowarn -cp "${LCM_JAR}" -d "${folder}/classes" ${classes}
    COMMAND "${Java_JAR_EXECUTABLE}" cf "${jar}" -C "${folder}/classes" .
    DEPENDS ${ARGN} COMMENT "Types for lcm-spy" VERBATIM)
  add_custom_target(lcm_spy_types ALL DEPENDS "${jar}")
endfunction()
