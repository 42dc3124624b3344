# cmake -DTYPE=<type>.lcm -DCLASS=<lcm-gen's header> -DHEADER=<type>.hpp -P CheckedDecoding.cmake
#
# LCM's decoder trusts the counts and lengths in a packet. This script writes HEADER, which includes
# CLASS and adds the check that common's decode() makes before it decodes an encoding
# (lcmtypes/encoding_checker.hpp). The check is made from the definition alone, so it does not depend
# on the C++ text that a version of lcm-gen writes. Every field of the definition becomes one line of
# the check. A definition that the script does not understand in full ends the build: HEADER is then
# missing, and nothing compiles that uses the type.
cmake_minimum_required(VERSION 3.25)

# Ends the build with one line: CMake does not wrap a line that starts with a space.
function(refuse found expected)
  string(SUBSTRING "${found}" 0 60 found)
  message(FATAL_ERROR " ${TYPE}: found \"${found}\", expected ${expected}; write it so, or extend "
    "${CMAKE_CURRENT_FUNCTION_LIST_FILE} and lcmtypes/encoding_checker.hpp")
endfunction()

set(bytes_of_boolean 1)
set(bytes_of_byte 1)
set(bytes_of_int8_t 1)
set(bytes_of_int16_t 2)
set(bytes_of_int32_t 4)
set(bytes_of_int64_t 8)
set(bytes_of_float 4)
set(bytes_of_double 8)

file(REMOVE "${HEADER}")
file(READ "${TYPE}" text)
string(REGEX REPLACE "//[^\n]*" "" text "${text}")
string(REGEX REPLACE "[ \t\r\n]+" " " text "${text}")
set(name "[A-Za-z_][A-Za-z_0-9]*")
if(NOT text MATCHES "^ ?package (${name}) ?; ?struct (${name}) ?{(.*)} ?$")
  refuse("${text}" "one \"package NAME; struct NAME { ... }\"")
endif()
set(package "${CMAKE_MATCH_1}")
set(struct "${CMAKE_MATCH_2}")
set(statements "${CMAKE_MATCH_3}")

set(types)
set(names)
set(counts)  # 1 where the field is no list
while(NOT statements MATCHES "^ ?$")
  if(statements MATCHES "^ ?const ${name} [^;]*;(.*)$")
    set(statements "${CMAKE_MATCH_1}")
  elseif(statements MATCHES "^ ?(${name}) (${name}) ?(\\[ ?(${name}|[1-9][0-9]*) ?\\])? ?;(.*)$"
         AND NOT CMAKE_MATCH_1 STREQUAL struct)
    set(count 1)
    if(CMAKE_MATCH_3)
      set(count "${CMAKE_MATCH_4}")
    endif()
    list(APPEND types "${CMAKE_MATCH_1}")
    list(APPEND names "${CMAKE_MATCH_2}")
    list(APPEND counts "${count}")
    set(statements "${CMAKE_MATCH_5}")
  else()
    string(REGEX REPLACE ";.*" ";" statement "${statements}")
    string(STRIP "${statement}" statement)
    refuse("${statement}" "\"TYPE NAME;\" or \"TYPE NAME[COUNT];\" with a TYPE other than ${struct}")
  endif()
endwhile()

set(lines "")
foreach(type name count IN ZIP_LISTS types names counts)
  if(name IN_LIST counts)
    set(line "const std::int64_t ${name} = packet.count<${type}>();")
  elseif(DEFINED bytes_of_${type})
    set(line "packet.numbers(${bytes_of_${type}}, ${count});  // ${name}")
  elseif(type STREQUAL "string")
    set(line "packet.strings(${count});  // ${name}")
  else()
    set(line "packet.structs<${type}>(${count});  // ${name}")
  endif()
  string(APPEND lines "  ${line}\n")
endforeach()

file(WRITE "${HEADER}" "// Made by cmake/CheckedDecoding.cmake from the definition of ${struct}.
#pragma once
#include \"${CLASS}\"
#include \"lcmtypes/encoding_checker.hpp\"

namespace ${package} {

inline void checkFields(lab::EncodingChecker& packet, const ${struct}* /*type*/) {
${lines}}

}  // namespace ${package}
")
