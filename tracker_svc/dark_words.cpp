#include "tracker_svc/dark_words.hpp"

#include <emmintrin.h>

#include <algorithm>
#include <bit>
#include <cstring>

namespace lab::tracker {
namespace {

using Bytes = std::uint8_t __attribute__((vector_size(kWord)));

/// Which bytes have their top bit set. Of two halves: this much every processor has.
[[gnu::always_inline]] inline std::uint32_t topBits(const Bytes& bytes) {
  __m128i half[2];
  std::memcpy(half, &bytes, sizeof half);
  return static_cast<std::uint32_t>(_mm_movemask_epi8(half[0])) |
         static_cast<std::uint32_t>(_mm_movemask_epi8(half[1])) << 16;
}

[[gnu::always_inline]] inline bool anyTopBit(const Bytes& bytes) {
  __m128i half[2];
  std::memcpy(half, &bytes, sizeof half);
  return _mm_movemask_epi8(_mm_or_si128(half[0], half[1])) != 0;
}

/// Pixels that are dark a bit beside them too, and not to both ends of a pair as in something long.
/// @param worst the brighter end of the darkest pair
/// @param dark loses the others
[[gnu::always_inline]] inline void keepDarkToTheSides(const std::uint8_t* at, std::ptrdiff_t stride,
                                                      const Neighbours& to, const Levels& levels,
                                                      const Bytes& here, const Bytes& best,
                                                      const Bytes& worst, Bytes& dark) {
  const Bytes contrast = best - here;
  const Bytes fifth = (contrast >> 3) + (contrast >> 4);
  const Bytes above = fifth > levels.noise ? fifth : Bytes{} + levels.noise;
  const auto ends = (here + above <= worst) | (contrast < levels.faint);
  Bytes beside{};
  for (const std::ptrdiff_t near : {static_cast<std::ptrdiff_t>(to.near), to.near * stride}) {
    Bytes one;
    Bytes other;
    std::memcpy(&one, at - near, sizeof one);
    std::memcpy(&other, at + near, sizeof other);
    const Bytes brighter = one > other ? one : other;
    beside = beside > brighter ? beside : brighter;
  }
  dark &= reinterpret_cast<Bytes>(ends & (beside <= best - (best >> 2)));
}

}  // namespace

Levels levelsOf(int black, int noise) {
  Levels levels;
  levels.black = static_cast<std::uint8_t>(black);
  levels.noise = static_cast<std::uint8_t>(noise);
  levels.faint = static_cast<std::uint8_t>(std::min(kFaint * noise, 255));
  levels.clear = static_cast<std::uint8_t>(std::max(noise - black, 0));
  levels.barely = static_cast<std::uint8_t>(std::max(noise / 2 - black / 8, 0));
  levels.most = static_cast<std::uint8_t>((255 - levels.clear) / 2 - 1);
  return levels;
}

// One loop without calls: the tests come in the order of what they cost and refuse, and a word is
// left at the first that none of its pixels passes.
__attribute__((target_clones("avx2", "default"))) int darkWords(
    const std::uint8_t* row, std::ptrdiff_t stride, const int* starts,
    const Neighbours* neighbours, std::uint64_t wanted, std::ptrdiff_t ahead,
    const Levels& levels, DarkWord* found) {
  const Bytes low = Bytes{} + levels.black;
  const Bytes most = Bytes{} + levels.most;
  const Bytes barely = Bytes{} + levels.barely;
  int count = 0;
  for (; wanted != 0; wanted &= wanted - 1) {
    const int word = std::countr_zero(wanted);
    const Neighbours& to = neighbours[word];
    if (to.across == 0) continue;
    const std::uint8_t* at = row + starts[word];
    __builtin_prefetch(at + ahead);
    Bytes here;
    Bytes one;
    Bytes other;
    std::memcpy(&here, at, sizeof here);
    std::memcpy(&one, at - to.across, sizeof one);
    std::memcpy(&other, at + to.across, sizeof other);
    here = here > low ? here : low;
    const Bytes least = here + (here >> 3) + barely;
    Bytes darker = one < other ? one : other;  // end of a pair
    Bytes dark = reinterpret_cast<Bytes>((least <= darker) & (here <= most));
    if (!anyTopBit(dark)) continue;
    Bytes best = darker;
    Bytes worst = one > other ? one : other;

    const std::ptrdiff_t column = to.across * stride;
    std::memcpy(&one, at - column, sizeof one);
    std::memcpy(&other, at + column, sizeof other);
    darker = one < other ? one : other;
    dark &= reinterpret_cast<Bytes>(least <= darker);
    if (!anyTopBit(dark)) continue;
    best = best > darker ? best : darker;
    Bytes brighter = one > other ? one : other;
    worst = worst < brighter ? worst : brighter;

    for (const std::ptrdiff_t diagonal : {to.diagonal * (stride + 1), to.diagonal * (stride - 1)}) {
      std::memcpy(&one, at - diagonal, sizeof one);
      std::memcpy(&other, at + diagonal, sizeof other);
      darker = one < other ? one : other;
      dark &= reinterpret_cast<Bytes>(least <= darker);
      best = best > darker ? best : darker;
      brighter = one > other ? one : other;
      worst = worst < brighter ? worst : brighter;
    }
    dark &= reinterpret_cast<Bytes>(here + here + levels.clear <= best);
    if (!anyTopBit(dark)) continue;

    keepDarkToTheSides(at, stride, to, levels, here, best, worst, dark);
    if (!anyTopBit(dark)) continue;
    DarkWord& out = found[count++];
    out.number = word;
    const Bytes white = best & dark;
    std::memcpy(out.white, &white, sizeof white);
    out.dark = topBits(dark);
  }
  return count;
}

}  // namespace lab::tracker
