#include "analyzer/laws/si_dimension.hpp"

#include <cstddef>

namespace lab::analysis {

language::Dimension dimensionOf(const std::string& unit) {
  language::Dimension dimension;
  int sign = 1;
  for (std::size_t at = 0; at < unit.size();) {
    const std::size_t end = unit.find_first_of(" /()", at);
    std::string word = unit.substr(at, end - at);
    int exponent = 1;
    if (const std::size_t power = word.find('^'); power != std::string::npos) {
      exponent = std::stoi(word.substr(power + 1));
      word.resize(power);
    }
    if (word == "m") dimension.length += sign * exponent;
    if (word == "s") dimension.time += sign * exponent;
    if (word == "volt") dimension.voltage += sign * exponent;
    if (end == std::string::npos) break;
    if (unit[end] == '/') sign = -1;
    at = end + 1;
  }
  return dimension;
}

}  // namespace lab::analysis
