/// Glyphs of 5 x 7 pixels for text on pictures.
///
/// Not stb_easy_font: callers place labels and right-align numbers by a fixed glyph width,
/// changing numbers must not move the text behind them, and stb_easy_font reads outside its tables
/// for bytes that are not printable ASCII.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace lab::optics {

/// Advance to the next glyph and to the next line [px].
inline constexpr int kGlyphWidth = 6;
inline constexpr int kGlyphHeight = 9;

/// Seven rows from the top, five bits each, the highest bit on the left. Contains capitals, digits
/// and the signs that numbers need; lower case is mapped to capitals, anything else to a box.
[[nodiscard]] const std::array<std::uint8_t, 7>& glyphRows(char sign);

/// Calls `paint(x, y)` for every pixel of a text with its top left corner at (left, top), magnified
/// by `size`.
template <class Paint>
void forEachGlyphPixel(std::string_view text, int left, int top, int size, Paint&& paint) {
  constexpr int kColumns = 5;
  for (const char sign : text) {
    const auto& rows = glyphRows(sign);
    for (int row = 0; row < static_cast<int>(rows.size()) * size; ++row) {
      const unsigned bits = rows[static_cast<std::size_t>(row / size)];
      for (int column = 0; column < kColumns * size; ++column) {
        if ((bits >> static_cast<unsigned>(kColumns - 1 - column / size) & 1U) == 0) continue;
        paint(left + column, top + row);
      }
    }
    left += kGlyphWidth * size;
  }
}

}  // namespace lab::optics
