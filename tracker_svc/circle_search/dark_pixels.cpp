#include "tracker_svc/circle_search/dark_pixels.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "light/field/target_clones.hpp"
#include "tracker_svc/circle_search/byte_lanes.hpp"

namespace lab::detector {
namespace {

constexpr std::size_t kMostWords = 64;

/// State of a word after comparing pairs of neighbours.
struct Paired {
  int number;
  const std::uint8_t* at;
  Bytes here;
  Bytes best;     ///< darker end of the brightest pair
  Bytes worst;    ///< brighter end of the darkest pair
  Bytes darkest;  ///< of all ends
  Bytes dark;     ///< remaining pixels
};

/// Pixels whose near neighbours are dark too, but not both ends of a pair, as in an elongated
/// object.
[[gnu::always_inline]] inline Bytes darkToTheSides(const Paired& word, std::ptrdiff_t stride,
                                                   const Neighbours& to, const Levels& levels) {
  const Bytes contrast = word.best - word.here;
  const Bytes fifth = (contrast >> 3) + (contrast >> 4);
  const Bytes above = fifth > levels.noise ? fifth : Bytes{} + levels.noise;
  const auto ends = (word.here + above <= word.worst) | (contrast < levels.faint);
  const std::ptrdiff_t near = to.near;
  const std::ptrdiff_t down = near * stride;
  const Bytes along = brighterOf(loadBytes(word.at - near), loadBytes(word.at + near));
  // The tested row may lie above or below the circle's middle.
  const Bytes across = darkerOf(loadBytes(word.at - down), loadBytes(word.at + down));
  const Bytes beside = brighterOf(along, across);
  const auto quarter = static_cast<std::uint8_t>(levels.black / 4);
  const auto round = ends & (beside <= word.best - (word.best >> 2) + quarter);
  return word.dark & reinterpret_cast<Bytes>(round);
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

// Branches on the content of a word would be mispredicted, which costs more than the tests: all
// words are tested without branches, and results without candidates are overwritten.
LAB_TARGET_CLONES int findDarkPixels(const std::uint8_t* row, std::ptrdiff_t stride,
                                     const int* starts, const Neighbours* neighbours,
                                     std::uint64_t wanted, std::ptrdiff_t ahead,
                                     const Levels& levels, DarkPixelWord* found) {
  const Bytes low = Bytes{} + levels.black;
  const Bytes most = Bytes{} + levels.most;
  // Values below 0 wrap around, and so do the sums, which gives the right result.
  const Bytes barely = Bytes{} + static_cast<std::uint8_t>(levels.barely);
  const Bytes clear = Bytes{} + static_cast<std::uint8_t>(levels.clear);
  Paired paired[kMostWords];
  int pairs = 0;
  Neighbours to{};  // of the previous word: mostly the same for the next
  std::ptrdiff_t ways[4] = {};
  std::ptrdiff_t soon = 0;
  for (; wanted != 0; wanted &= wanted - 1) {
    const int number = std::countr_zero(wanted);
    if (neighbours[number] != to) {
      to = neighbours[number];
      ways[0] = to.across;
      ways[1] = to.across * stride;
      ways[2] = to.diagonal * (stride + 1);
      ways[3] = to.diagonal * (stride - 1);
      soon = to.near * stride + ahead;
    }
    if (to.across == 0) continue;
    const std::uint8_t* at = row + starts[number];
    // Prefetches rows that neither the prefilter nor the tests have read.
    __builtin_prefetch(at + soon, 0, 2);
    __builtin_prefetch(at + soon - stride, 0, 2);
    __builtin_prefetch(at + soon + stride, 0, 2);
    const Bytes here = brighterOf(loadBytes(at), low);
    const Bytes least = here + (here >> 3) + barely;
    Bytes best{};
    Bytes worst = ~Bytes{};
    Bytes darkest = worst;  // of all ends
#pragma GCC unroll 4
    for (const std::ptrdiff_t away : ways) {
      const Bytes one = loadBytes(at - away);
      const Bytes other = loadBytes(at + away);
      const Bytes darker = darkerOf(one, other);
      darkest = darkerOf(darkest, darker);
      best = brighterOf(best, darker);
      worst = darkerOf(worst, brighterOf(one, other));
    }
    const auto dark = (least <= darkest) & (here <= most) & (here + here + clear <= best);
    const auto left = reinterpret_cast<Bytes>(dark);
    const int kept = anyTopBit(left) ? 1 : 0;
    paired[pairs] = {number, at, here, best, worst, darkest, left};
    pairs += kept;
  }
  int count = 0;
  for (int i = 0; i < pairs; ++i) {
    const Paired& word = paired[i];
    const Bytes dark = darkToTheSides(word, stride, neighbours[word.number], levels);
    DarkPixelWord& out = found[count];
    out.number = word.number;
    const Bytes white = word.best & dark;
    std::memcpy(out.white, &white, sizeof white);
    out.dark = topBits(dark);
    const Bytes clearly = word.here + ((word.best - word.here) >> 3);
    out.round = topBits(dark & reinterpret_cast<Bytes>(clearly <= word.darkest));
    count += out.dark != 0 ? 1 : 0;
  }
  return count;
}

}  // namespace lab::detector
