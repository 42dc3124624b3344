# lab_embed_files(library NAMESPACE function FILES file... [NAMES name...])
# Embeds files in a library. `function` of `NAMESPACE` returns them with their names
# (dashboard/web/page_files.hpp). NAMES gives other names than the file names, one for each file.
function(lab_embed_files library namespace function)
  cmake_parse_arguments(ARG "" "" "FILES;NAMES" ${ARGN})
  set(bytes)
  set(symbols)
  set(rows)
  set(number 0)
  foreach(file IN LISTS ARG_FILES)
    if(ARG_NAMES)
      list(GET ARG_NAMES ${number} name)
    else()
      cmake_path(GET file FILENAME name)
    endif()
    set(symbol "lab_${function}_${number}")
    string(APPEND bytes "asm(\".pushsection .rodata\\n.global ${symbol}\\n${symbol}:\\n\"\n"
      "    \".incbin \\\"${file}\\\"\\n.global ${symbol}_end\\n${symbol}_end:\\n.byte 0\\n.popsection\");\n")
    string(APPEND symbols "extern const char ${symbol}[];\nextern const char ${symbol}_end[];\n")
    string(APPEND rows "      {\"${name}\", {${symbol}, ${symbol}_end}},\n")
    math(EXPR number "${number} + 1")
  endforeach()
  set(source "${CMAKE_CURRENT_BINARY_DIR}/${function}.cpp")
  file(CONFIGURE OUTPUT "${source}" @ONLY CONTENT "// Made by cmake/EmbedFiles.cmake.
#include \"dashboard/web/page_files.hpp\"

@bytes@
extern \"C\" {
@symbols@}

namespace @namespace@ {

const std::vector<PageFile>& @function@() {
  static const std::vector<PageFile> files{
@rows@  };
  return files;
}

}  // namespace @namespace@
")
  target_sources(${library} PRIVATE "${source}")
  set_source_files_properties("${source}" PROPERTIES OBJECT_DEPENDS "${ARG_FILES}"
    SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()
