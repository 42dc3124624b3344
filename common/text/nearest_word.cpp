#include "common/text/nearest_word.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace lab {
namespace {

char lower(char letter) {
  return letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter;
}

// Words that somebody types are shorter. The time of editDistance() is the product of both lengths,
// and names in the file of a stranger have any length.
constexpr std::size_t kLongestWord = 64;

bool equal(char a, char b) { return lower(a) == lower(b); }

/// The most changes with which two words still count as similar. In words of up to three letters
/// two changes leave nothing in common.
std::size_t mostChanges(std::string_view word) {
  return word.size() < 4 ? 1 : std::max<std::size_t>(2, word.size() / 3);
}

}  // namespace

std::size_t editDistance(std::string_view a, std::string_view b) {
  // Distances of the first i letters of a to the first j letters of b.
  std::vector<std::size_t> before_last(b.size() + 1);
  std::vector<std::size_t> last(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::vector<std::size_t> row(b.size() + 1, i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t changed = equal(a[i - 1], b[j - 1]) ? 0 : 1;
      row[j] = std::min({last[j - 1] + changed, row[j - 1] + 1, last[j] + 1});
      if (i > 1 && j > 1 && equal(a[i - 1], b[j - 2]) && equal(a[i - 2], b[j - 1])) {
        row[j] = std::min(row[j], before_last[j - 2] + 1);
      }
    }
    before_last = std::exchange(last, std::move(row));
  }
  return last.back();
}

std::string nearestWord(std::string_view word, const std::vector<std::string>& words) {
  std::string nearest;
  if (word.size() > kLongestWord) return nearest;
  std::size_t least = mostChanges(word) + 1;
  for (const std::string& candidate : words) {
    if (candidate.size() > kLongestWord) continue;
    const std::size_t distance = editDistance(word, candidate);
    if (distance < least) {
      least = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

std::string didYouMean(std::string_view word, const std::vector<std::string>& words,
                       std::string (*shown)(std::string_view)) {
  const std::string nearest = nearestWord(word, words);
  if (nearest.empty()) return {};
  return "; did you mean " + (shown == nullptr ? nearest : shown(nearest)) + "?";
}

}  // namespace lab
