#include "tracker_svc/dark_words.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "tracker_svc/byte_lanes.hpp"

namespace lab::tracker {
namespace {

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
    beside = brighterOf(beside, brighterOf(loadBytes(at - near), loadBytes(at + near)));
  }
  const auto quarter = static_cast<std::uint8_t>(levels.black / 4);
  dark &= reinterpret_cast<Bytes>(ends & (beside <= best - (best >> 2) + quarter));
}

}  // namespace

Levels levelsOf(int black, int noise) {
  Levels levels;
  levels.black = static_cast<std::uint8_t>(black);
  levels.noise = static_cast<std::uint8_t>(noise);
  levels.faint = static_cast<std::uint8_t>(std::min(kFaint * noise, 255));
  levels.clear = noise - black;
  levels.barely = noise / 2 - black / 8;
  levels.most = static_cast<std::uint8_t>((255 - levels.clear) / 2 - 1);
  return levels;
}

// One loop without calls: the tests come in the order of what they cost and refuse. A word is left
// where few go on, along the row and after the pairs; a branch more would cost what it saves.
__attribute__((target_clones("avx2", "default"))) int darkWords(
    const std::uint8_t* row, std::ptrdiff_t stride, const int* starts,
    const Neighbours* neighbours, std::uint64_t wanted, std::ptrdiff_t ahead,
    const Levels& levels, DarkWord* found) {
  const Bytes low = Bytes{} + levels.black;
  const Bytes most = Bytes{} + levels.most;
  // Where they are below 0 they wrap round, and so do the sums: back to where they belong.
  const Bytes barely = Bytes{} + static_cast<std::uint8_t>(levels.barely);
  const Bytes clear = Bytes{} + static_cast<std::uint8_t>(levels.clear);
  int count = 0;
  for (; wanted != 0; wanted &= wanted - 1) {
    const int word = std::countr_zero(wanted);
    const Neighbours& to = neighbours[word];
    if (to.across == 0) continue;
    const std::uint8_t* at = row + starts[word];
    __builtin_prefetch(at + ahead);
    const Bytes here = brighterOf(loadBytes(at), low);
    const Bytes least = here + (here >> 3) + barely;
    Bytes one = loadBytes(at - to.across);
    Bytes other = loadBytes(at + to.across);
    Bytes darker = darkerOf(one, other);  // end of a pair
    Bytes dark = reinterpret_cast<Bytes>((least <= darker) & (here <= most));
    if (!anyTopBit(dark)) continue;
    Bytes best = darker;
    Bytes worst = brighterOf(one, other);

    const std::ptrdiff_t column = to.across * stride;
    one = loadBytes(at - column);
    other = loadBytes(at + column);
    darker = darkerOf(one, other);
    dark &= reinterpret_cast<Bytes>(least <= darker);
    best = brighterOf(best, darker);
    worst = darkerOf(worst, brighterOf(one, other));

    for (const std::ptrdiff_t diagonal : {to.diagonal * (stride + 1), to.diagonal * (stride - 1)}) {
      one = loadBytes(at - diagonal);
      other = loadBytes(at + diagonal);
      darker = darkerOf(one, other);
      dark &= reinterpret_cast<Bytes>(least <= darker);
      best = brighterOf(best, darker);
      worst = darkerOf(worst, brighterOf(one, other));
    }
    dark &= reinterpret_cast<Bytes>(here + here + clear <= best);
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
