#include "common/text/json_text.hpp"

#include <cstddef>

namespace lab {

bool isNestedDeeper(std::string_view json, int depth) {
  int open = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char letter = json[i];
    if (in_string) {
      if (letter == '\\') ++i;
      in_string = letter != '"';
    } else if (letter == '"') {
      in_string = true;
    } else if (letter == '[' || letter == '{') {
      if (++open > depth) return true;
    } else if (letter == ']' || letter == '}') {
      --open;
    }
  }
  return false;
}

}  // namespace lab
