/// Finds dark pixels between bright neighbours in one row, 32 pixels at once.
#pragma once

#include <cstddef>
#include <cstdint>

namespace lab::detector {

inline constexpr int kWord = 32;  // pixels tested at once
inline constexpr int kFaint = 3;  // [noise] contrast below which single pixels are unreliable

/// Where the neighbours of a pixel are [px].
struct Neighbours {
  std::int16_t across = 0;    ///< in its row and in its column; 0: do not test
  std::int16_t diagonal = 0;  ///< on the diagonals, each way
  std::int16_t near = 0;      ///< inside both circles

  bool operator==(const Neighbours&) const = default;
};

/// Thresholds [DN]; sums stay within a byte for pixels from `black` to `most`.
struct Levels {
  std::uint8_t black = 0;
  std::uint8_t most = 0;   ///< brighter pixels belong to no circle
  int clear = 0;           ///< added to twice the pixel: clearly darker despite noise
  int barely = 0;          ///< added to 9/8 of the pixel: slightly darker
  std::uint8_t faint = 0;  ///< contrasts below this are unreliable for single pixels
  std::uint8_t noise = 0;  ///< a difference that read noise alone does not cause
};

/// Thresholds such that pixel p above black b is clearly darker than white w if 2 (p - b) + noise
/// <= w - b.
[[nodiscard]] Levels levelsOf(int black, int noise);

/// A word that contains dark pixels.
struct DarkPixelWord {
  int number = 0;
  std::uint32_t dark = 0;          ///< bit i: pixel i
  std::uint32_t round = 0;         ///< subset that is darker than all eight neighbours by an
                                   ///< eighth of the contrast: may be a complete circle
  std::uint8_t white[kWord] = {};  ///< [DN] darker end of the best pair of neighbours of each dark
                                   ///< pixel; 0 elsewhere
};

/// Tests the wanted words of one row. A pixel of a circle is clearly darker than both ends of at
/// least one pair of opposite neighbours, and slightly darker than all eight (behind a light edge,
/// white may have a seventh of its light left). No pair may be as dark as the pixel at both ends,
/// as in an elongated object; a line is white again at a distance where a circle is still dark.
/// @param row first pixel of the picture's row
/// @param stride [bytes] from one row of the picture to the next
/// @param starts of the words [px]
/// @param neighbours by word
/// @param wanted bit i: test word i
/// @param ahead [bytes] to the row to prefetch
/// @param found receives the words with dark pixels, in order; room for 64
/// @return number of words found
int findDarkPixels(const std::uint8_t* row, std::ptrdiff_t stride, const int* starts,
                   const Neighbours* neighbours, std::uint64_t wanted, std::ptrdiff_t ahead,
                   const Levels& levels, DarkPixelWord* found);

}  // namespace lab::detector
