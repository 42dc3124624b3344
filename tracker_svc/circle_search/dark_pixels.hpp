/// Which pixels of a row are dark between bright neighbours: the first look of the search, 32 at
/// once.
#pragma once

#include <cstddef>
#include <cstdint>

namespace lab::detector {

inline constexpr int kWord = 32;  // pixels tested at once
inline constexpr int kFaint = 3;  // [noise] a contrast at which single pixels are no guide

/// Where the neighbours of a pixel are [px].
struct Neighbours {
  std::int16_t across = 0;    ///< in its row and in its column, 0: not to be tested
  std::int16_t diagonal = 0;  ///< on the diagonals, each way
  std::int16_t near = 0;      ///< inside of both circles

  bool operator==(const Neighbours&) const = default;
};

/// What a row is tested with [DN]; sums stay within a byte for pixels from `black` to `most`.
struct Levels {
  std::uint8_t black = 0;
  std::uint8_t most = 0;   ///< brighter pixels are in no circle
  int clear = 0;           ///< added to twice the pixel: clearly darker, whatever the noise
  int barely = 0;          ///< added to 9/8 of the pixel: darker at all
  std::uint8_t faint = 0;  ///< smaller contrasts say nothing about single pixels
  std::uint8_t noise = 0;  ///< a difference that read noise alone does not make
};

/// Pixels p above black b that are clearly darker than white w: 2 (p - b) + noise <= w - b.
[[nodiscard]] Levels levelsOf(int black, int noise);

/// A word with pixels that may be of circles.
struct DarkPixelWord {
  int number = 0;
  std::uint32_t dark = 0;          ///< bit i: pixel i
  std::uint32_t round = 0;         ///< those of them that all eight neighbours outshine by an
                                   ///< eighth of the contrast: may be of a whole circle
  std::uint8_t white[kWord] = {};  ///< [DN] of each such pixel's best pair of neighbours, the
                                   ///< darker end; 0 elsewhere
};

/// Tests some words of one row. A pixel of a circle is clearly darker than both ends of one pair of
/// opposite neighbours, and at least a bit darker than all eight: beside a circle in full light may
/// lie white that a light edge has left a seventh of its light. No pair is as dark as the pixel at
/// both ends, as in something long. Lines are white again where a circle is still dark.
/// @param row the first pixel of the picture's row
/// @param stride [bytes] from one row of the picture to the next
/// @param starts of the words [px]
/// @param neighbours by word
/// @param wanted bit i: word i is to be tested
/// @param ahead [bytes] from here to the row that is tested soon
/// @param found the words found, in order; room for 64
/// @return how many
int findDarkPixels(const std::uint8_t* row, std::ptrdiff_t stride, const int* starts,
                   const Neighbours* neighbours, std::uint64_t wanted, std::ptrdiff_t ahead,
                   const Levels& levels, DarkPixelWord* found);

}  // namespace lab::detector
