#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lab::language {

/// Finds the word that somebody meant: "; did you mean X?", or nothing. It is passed from outside
/// (common/text/nearest_word.hpp), because the language depends on the robot's machine only.
using Suggest = std::string (*)(std::string_view word, const std::vector<std::string>& words);

[[nodiscard]] inline std::string suggestion(Suggest suggest, std::string_view word,
                                            const std::vector<std::string>& words) {
  return suggest == nullptr ? std::string() : suggest(word, words);
}

}  // namespace lab::language
