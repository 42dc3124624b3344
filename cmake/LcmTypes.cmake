# C++ types of the messages. Debian's liblcm-dev has neither lcmConfig.cmake nor a usable lcm.pc, so the
# library and its generator are searched for here. A newer LCM with its own package file is preferred.
find_package(lcm CONFIG QUIET)
if(NOT TARGET lcm::lcm)
  find_path(LCM_INCLUDE_DIR lcm/lcm-cpp.hpp REQUIRED)
  find_library(LCM_LIBRARY lcm REQUIRED)
  add_library(lcm::lcm UNKNOWN IMPORTED)
  set_target_properties(lcm::lcm PROPERTIES
    IMPORTED_LOCATION "${LCM_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${LCM_INCLUDE_DIR}")
endif()
find_program(LCM_GEN lcm-gen REQUIRED)

# add_lcm_types(target package file.lcm...)
# An interface library with one generated header per file: lcm-gen's class and the check of its encoding.
# The headers are SYSTEM, because lcm-gen's code causes warnings.
function(add_lcm_types target package)
  set(out "${CMAKE_CURRENT_BINARY_DIR}/gen")
  set(checked_decoding "${PROJECT_SOURCE_DIR}/cmake/CheckedDecoding.cmake")
  set(headers)
  foreach(file IN LISTS ARGN)
    get_filename_component(type "${file}" NAME_WE)
    set(class "lcm_gen/${package}/${type}.hpp")
    set(header "${out}/${package}/${type}.hpp")
    add_custom_command(
      OUTPUT "${header}"
      BYPRODUCTS "${out}/${class}"
      COMMAND "${LCM_GEN}" --cpp --cpp-std c++11 --cpp-hpath "${out}/lcm_gen"
              "${CMAKE_CURRENT_SOURCE_DIR}/${file}"
      COMMAND "${CMAKE_COMMAND}" "-DTYPE=${CMAKE_CURRENT_SOURCE_DIR}/${file}" "-DCLASS=${class}"
              "-DHEADER=${header}" -P "${checked_decoding}"
      DEPENDS "${file}" "${checked_decoding}"
      VERBATIM)
    list(APPEND headers "${header}")
  endforeach()
  add_custom_target(${target}_gen DEPENDS ${headers})
  add_library(${target} INTERFACE)
  add_dependencies(${target} ${target}_gen)
  target_include_directories(${target} SYSTEM INTERFACE "${out}")
  target_link_libraries(${target} INTERFACE lcm::lcm)
endfunction()
