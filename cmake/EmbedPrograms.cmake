# lab_embed_programs(library)
# Embeds the programs of motion in programs/ in a library (common/programs/shipped_texts.hpp).
function(lab_embed_programs library)
  file(GLOB files CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/programs/*.toml")
  set(rows)
  foreach(file IN LISTS files)
    cmake_path(GET file STEM name)
    file(READ "${file}" text)
    string(APPEND rows "      {\"${name}\", R\"toml(${text})toml\"},\n")
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${file}")
  endforeach()
  set(source "${CMAKE_CURRENT_BINARY_DIR}/shipped_texts.cpp")
  file(CONFIGURE OUTPUT "${source}" @ONLY CONTENT "// Made by cmake/EmbedPrograms.cmake.
#include \"common/programs/shipped_texts.hpp\"

namespace lab {

const std::vector<ShippedText>& shippedTexts() {
  static const std::vector<ShippedText> texts{
@rows@  };
  return texts;
}

}  // namespace lab
")
  target_sources(${library} PRIVATE "${source}")
endfunction()
