#include "common/text/utf8.hpp"

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace lab {
namespace {

constexpr const char* kReplacement = "\xEF\xBF\xBD";

/// The first character of a text, or the first maximal subpart of an ill-formed one.
struct Piece {
  std::size_t size;
  bool valid;
};

/// @param text not empty
Piece firstPiece(std::string_view text) {
  const auto byte = [text](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  const std::uint8_t lead = byte(0);
  if (lead < 0x80) return {1, true};
  if (lead < 0xC2 || lead > 0xF4) return {1, false};
  const std::size_t size = lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
  // Limits of the second byte, which exclude overlong forms, surrogates, and all above U+10FFFF.
  std::uint8_t low = 0x80;
  std::uint8_t high = 0xBF;
  if (lead == 0xE0) low = 0xA0;
  if (lead == 0xED) high = 0x9F;
  if (lead == 0xF0) low = 0x90;
  if (lead == 0xF4) high = 0x8F;
  for (std::size_t i = 1; i < size; ++i) {
    if (i == text.size() || byte(i) < low || byte(i) > high) return {i, false};
    low = 0x80;
    high = 0xBF;
  }
  return {size, true};
}

/// The length of the valid beginning of a text [bytes].
std::size_t validPart(std::string_view text) {
  std::size_t end = 0;
  while (end < text.size()) {
    const Piece piece = firstPiece(text.substr(end));
    if (!piece.valid) break;
    end += piece.size;
  }
  return end;
}

}  // namespace

void repairUtf8(std::string& text) {
  std::size_t at = validPart(text);
  if (at == text.size()) return;
  std::string repaired = text.substr(0, at);
  while (at < text.size()) {
    const Piece piece = firstPiece(std::string_view(text).substr(at));
    repaired += piece.valid ? text.substr(at, piece.size) : kReplacement;
    at += piece.size;
  }
  text = std::move(repaired);
}

std::string_view utf8Prefix(std::string_view text, std::size_t most) {
  constexpr std::size_t kLongestCharacter = 4;
  if (text.size() <= most) return text;
  const auto continues = [text](std::size_t at) {
    return (static_cast<std::uint8_t>(text[at]) & 0xC0U) == 0x80U;
  };
  std::size_t size = most;
  while (size > 0 && size + kLongestCharacter > most + 1 && continues(size)) --size;
  return text.substr(0, size);
}

}  // namespace lab
