/// The word that somebody meant, for error messages.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace lab {

/// The least number of letters to insert, remove or replace, or of neighbours to swap, that makes
/// one word the other: the optimal string alignment distance. Upper and lower case are equal.
[[nodiscard]] std::size_t editDistance(std::string_view a, std::string_view b);

/// The element of `words` that is most similar to `word`; empty if none is similar. Words
/// above 64 bytes are similar to none.
[[nodiscard]] std::string nearestWord(std::string_view word, const std::vector<std::string>& words);

/// "; did you mean X?" with the nearest word as `shown` prints it; empty if none is similar.
[[nodiscard]] std::string didYouMean(std::string_view word, const std::vector<std::string>& words,
                                     std::string (*shown)(std::string_view) = nullptr);

}  // namespace lab
