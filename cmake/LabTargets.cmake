# Functions that define the targets. Warnings are errors, headers are included from the root
# (#include "robot/dynamics/program.hpp"), presets select sanitizers.
add_library(lab_options INTERFACE)
target_include_directories(lab_options INTERFACE "${PROJECT_SOURCE_DIR}")
target_compile_options(lab_options INTERFACE
  -Wall -Wextra -Wpedantic -Werror -Wshadow -Wconversion -Wsign-conversion -Wold-style-cast
  -Woverloaded-virtual -Wnon-virtual-dtor -Wdouble-promotion
  # g++ 12 reports false overlaps in "text" + std::string (GCC bug 105651).
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
if(LAB_SANITIZE)
  # The sanitizers do not detect an index between a vector's size and its capacity.
  target_compile_definitions(lab_options INTERFACE _GLIBCXX_ASSERTIONS)
  target_compile_options(lab_options INTERFACE -fsanitize=${LAB_SANITIZE} -fno-omit-frame-pointer
    -fno-sanitize-recover=all
    # With sanitizers, g++ gives false warnings of uninitialised variables (GCC manual) and of bounds.
    $<$<CXX_COMPILER_ID:GNU>:-Wno-tsan;-Wno-maybe-uninitialized;-Wno-array-bounds>)
  target_link_options(lab_options INTERFACE -fsanitize=${LAB_SANITIZE})
  if(LAB_SANITIZE MATCHES undefined AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    add_library(lab_ubsan_report SHARED "${PROJECT_SOURCE_DIR}/tests/support/ubsan_report.cpp")
    target_link_libraries(lab_options INTERFACE lab_ubsan_report)
  endif()
endif()

# Most of a compiler's time goes into headers that the sources of a library share. A unity build compiles
# sixteen sources at a time and takes a third of the time. ./lab uses it for a first build. Developers
# build without it: a change compiles one source, and a missing include shows.
option(LAB_UNITY_BUILD "Compile the sources of a library, and of tests, sixteen at a time" OFF)

function(lab_unity_build target)
  if(LAB_UNITY_BUILD)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 16)
    # To this warning every source of a batch is a header.
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  endif()
endfunction()

# For code that reads a file or a command line once and then waits: -Og halves the compile time.
function(lab_debug_optimised target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release,RelWithDebInfo>:-Og>)
endfunction()

# lab_library(name [NUMBERS|SHELL] SOURCES a.cpp... [LINK target...])
# NUMBERS is for inner loops and for results that must be equal to the bit: every source is compiled by
# itself, fully optimised. SHELL is for code outside of any inner loop: it is optimised less.
function(lab_library name)
  cmake_parse_arguments(ARG "NUMBERS;SHELL" "" "SOURCES;LINK" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PUBLIC lab_options ${ARG_LINK})
  if(ARG_SHELL)
    lab_debug_optimised(${name})
  endif()
  if(NOT ARG_NUMBERS)
    lab_unity_build(${name})
  endif()
endfunction()

# lab_program(name SOURCES main.cpp [LINK target...])
# Its own sources are compiled as SHELL.
function(lab_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  lab_debug_optimised(${name})
  target_link_libraries(${name} PRIVATE lab_options ${ARG_LINK})
endfunction()

# The processors of a test that computes, in the units of `ctest -j` and PROCESSORS: quarter cores.
set(LAB_CORE 4)

# The time limit of a test that is run by its own add_test(), in s. It only catches hangs.
set(LAB_TIME_LIMIT 600)
if(LAB_SANITIZE)  # up to ten times slower than an optimised build
  math(EXPR LAB_TIME_LIMIT "10 * ${LAB_TIME_LIMIT}")
endif()

# lab_test_program(name SOURCES x_test.cpp... [LINK target...] [OWN_OPTIONS])
# The program of a test that is run by its own add_test(). OWN_OPTIONS is for tests with other compile
# options, which cannot use the precompiled headers.
function(lab_test_program name)
  cmake_parse_arguments(ARG "OWN_OPTIONS" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE lab_options ${ARG_LINK} GTest::gmock GTest::gtest_main)
  if(NOT ARG_OWN_OPTIONS)
    target_precompile_headers(${name} REUSE_FROM lab_test_headers)
  endif()
endfunction()

# lab_test_group(name [SOURCES helper.cpp...] [LINK target...])
# The program of several tests, which lab_test(... IN name) adds: a folder's tests that link the same
# are compiled in batches, as the sources of a library are.
function(lab_test_group name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES} $<TARGET_OBJECTS:lab_test_main>)
  target_link_libraries(${name} PRIVATE lab_options ${ARG_LINK} GTest::gmock GTest::gtest)
  target_precompile_headers(${name} REUSE_FROM lab_test_headers)
  lab_unity_build(${name})
endfunction()

# lab_test(name SOURCES x_test.cpp... [IN group] [LINK target...] [OWN_OPTIONS] [LABELS label...]
#          [TIMEOUT s] [NETWORK])
# IN adds it to the program of that group; otherwise it is a separate program.
# NETWORK runs the test in a private network namespace, so that its messages do not leave it. All other
# tests use LCM in memory. NETWORK tests mostly wait and take one processor, a quarter of a core (LAB_CORE).
# They run in real time, so they also have the label realtime.
function(lab_test name)
  cmake_parse_arguments(ARG "NETWORK;OWN_OPTIONS" "TIMEOUT;IN" "SOURCES;LINK;LABELS" ${ARGN})
  set(program ${name})
  set(sources)
  if(ARG_IN AND ARG_OWN_OPTIONS)
    message(FATAL_ERROR "lab_test ${name}: with OWN_OPTIONS it cannot be IN ${ARG_IN}")
  endif()
  if(ARG_IN)
    set(program ${ARG_IN})
    foreach(source ${ARG_SOURCES})  # test_main selects sources by file name without folder
      cmake_path(GET source FILENAME file)
      list(APPEND sources ${file})
    endforeach()
    target_sources(${program} PRIVATE ${ARG_SOURCES})
    target_link_libraries(${program} PRIVATE ${ARG_LINK})
  else()
    set(own_options)
    if(ARG_OWN_OPTIONS)
      set(own_options OWN_OPTIONS)
    endif()
    lab_test_program(${name} SOURCES ${ARG_SOURCES} LINK ${ARG_LINK} ${own_options})
  endif()
  if(ARG_NETWORK)
    add_test(NAME ${name} COMMAND "${PROJECT_SOURCE_DIR}/tests/in_private_network.sh"
      $<TARGET_FILE:${program}> ${sources})
    list(APPEND ARG_LABELS realtime)
  else()
    add_test(NAME ${name} COMMAND ${program} ${sources})
    set_tests_properties(${name} PROPERTIES PROCESSORS ${LAB_CORE} ENVIRONMENT "LCM_DEFAULT_URL=memq://")
  endif()
  if(ARG_LABELS)
    set_tests_properties(${name} PROPERTIES LABELS "${ARG_LABELS}")
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT ${LAB_TIME_LIMIT})
  elseif(LAB_SANITIZE)
    math(EXPR ARG_TIMEOUT "10 * ${ARG_TIMEOUT}")
  endif()
  set_tests_properties(${name} PROPERTIES TIMEOUT ${ARG_TIMEOUT})
endfunction()

# lab_tests(prefix IN group [LABELS label...] [TIMEOUT s] [NETWORK] SOURCES x_test.cpp...)
# One test per source, in the program of its group: prefix_x is the test of x_test.cpp.
function(lab_tests prefix)
  cmake_parse_arguments(ARG "NETWORK" "TIMEOUT;IN" "SOURCES;LABELS" ${ARGN})
  set(options IN ${ARG_IN})
  if(ARG_NETWORK)
    list(APPEND options NETWORK)
  endif()
  if(ARG_TIMEOUT)
    list(APPEND options TIMEOUT ${ARG_TIMEOUT})
  endif()
  if(ARG_LABELS)
    list(APPEND options LABELS ${ARG_LABELS})
  endif()
  foreach(source ${ARG_SOURCES})
    cmake_path(GET source STEM name)
    string(REGEX REPLACE "_test$" "" name "${name}")
    lab_test(${prefix}_${name} SOURCES ${source} ${options})
  endforeach()
endfunction()

# lab_benchmark(name SOURCES x.cpp... [LINK target...])
# Runs alone, labelled long, and writes its results to tests/benchmarks/results/.
function(lab_benchmark name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE lab_options ${ARG_LINK} benchmark::benchmark)
  set(results "${PROJECT_SOURCE_DIR}/tests/benchmarks/results")
  file(MAKE_DIRECTORY "${results}")
  add_test(NAME ${name}
    COMMAND ${name} "--benchmark_out=${results}/${name}.json" --benchmark_out_format=json)
  set_tests_properties(${name} PROPERTIES LABELS long RUN_SERIAL ON TIMEOUT 600
    ENVIRONMENT "LCM_DEFAULT_URL=memq://")
endfunction()
