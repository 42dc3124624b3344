#include "tracker_svc/circle_search/contrast_prefilter.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "light/field/target_clones.hpp"
#include "tracker_svc/circle_search/byte_lanes.hpp"

namespace lab::detector {
namespace {

constexpr std::size_t kBits = 64;
constexpr int kLittle = 2;  // [1] times Levels::faint: white above black in dim light
// padding words before the first and after the last brightest word
constexpr std::size_t kBeside = 1;

/// Larger of the largest byte of `one` and that of `other`, the latter times 256.
[[gnu::always_inline]] inline int largest(const Bytes& one, const Bytes& other) {
  __m128i half[4];
  std::memcpy(half, &one, sizeof one);
  std::memcpy(half + 2, &other, sizeof other);
  const __m128i a = _mm_max_epu8(half[0], half[1]);
  const __m128i b = _mm_max_epu8(half[2], half[3]);
  __m128i both = _mm_max_epu8(_mm_unpacklo_epi8(a, b), _mm_unpackhi_epi8(a, b));
  both = _mm_max_epu8(both, _mm_srli_si128(both, 8));
  both = _mm_max_epu8(both, _mm_srli_si128(both, 4));
  both = _mm_max_epu8(both, _mm_srli_si128(both, 2));
  return _mm_cvtsi128_si32(both) & 0xffff;
}

/// Input of one row of cells.
struct CellRow {
  const std::uint8_t* top;   ///< first row that is read
  std::ptrdiff_t down;       ///< [bytes] from one row to the next
  const std::uint8_t* soon;  ///< first row of the next cells, to prefetch
  int soon_rows;             ///< number of those rows
};

/// Darkest and brightest pair of adjacent pixels of each cell.
[[gnu::always_inline]] inline void lookAtEach(const CellRow& row, int rows,
                                              const std::vector<int>& starts, std::uint8_t* dark,
                                              std::uint8_t* bright) {
  const std::size_t words = starts.size();
  for (std::size_t i = 0; i < words; ++i) {
    // Prefetch to the second-level cache only: few lines can be in flight to the first.
    for (int k = 0; k < row.soon_rows; ++k) {
      __builtin_prefetch(row.soon + k * row.down + starts[i], 0, 2);
    }
    const std::uint8_t* at = row.top + starts[i];
    Bytes darkest = ~Bytes{};
    Bytes brightest{};
#pragma GCC unroll 4
    for (int k = 0; k < rows; ++k, at += row.down) {
      const Bytes one = loadBytes(at);
      const Bytes other = loadBytes(at + 1);
      darkest = darkerOf(darkest, brighterOf(one, other));
      brightest = brighterOf(brightest, darkerOf(one, other));
    }
    const int extremes = largest(~darkest, brightest);
    dark[i] = static_cast<std::uint8_t>(~extremes);
    bright[i] = static_cast<std::uint8_t>(extremes >> 8);
  }
}

LAB_TARGET_CLONES void lookAtCells(const CellRow& row, int rows, const std::vector<int>& starts,
                                   std::uint8_t* dark, std::uint8_t* bright) {
  // Constant row counts let the compiler unroll.
  if (rows == 3) return lookAtEach(row, 3, starts, dark, bright);
  if (rows == 2) return lookAtEach(row, 2, starts, dark, bright);
  lookAtEach(row, rows, starts, dark, bright);
}

void put(std::uint32_t bits, std::size_t word, std::uint64_t& to) {
  to = word % kBits == 0 ? bits : to | std::uint64_t{bits} << kWord;
}

}  // namespace

ContrastPrefilter::ContrastPrefilter(int width, int height, const std::vector<int>& starts,
                                     int first, int step, int around)
    : starts_(starts),
      height_(height),
      first_(first),
      step_(step),
      tall_(std::max((around + step - 1) / step, 1) * step),
      cells_((height + tall_ - 1) / tall_),
      blocks_((starts.size() + kBits - 1) / kBits) {
  for (int& start : starts_) start = std::min(start, width - kWord - 1);
  width_ = blocks_ * kBits;
  dark_.assign(placeOf(cells_), 255);
  bright_.assign(placeOf(cells_) + 2 * kBeside, 0);
  words_.resize(static_cast<std::size_t>(cells_) * blocks_);
  faint_.resize(words_.size());
}

void ContrastPrefilter::look(const optics::GreyView& picture, const Levels& levels, int top,
                             int bottom) {
  const int first = top / tall_;
  const int last = bottom / tall_;
  for (int cell = std::max(first - 1, 0); cell <= std::min(last + 1, cells_ - 1); ++cell) {
    lookAtRow(picture, cell);
  }
  compare(levels, first, last);
}

ContrastPrefilter::Span ContrastPrefilter::rowsOf(int cell) const {
  const int top = first_ + cell * tall_;
  const int end = std::min(top + tall_, height_);
  return {top, std::max((end - top + step_ - 1) / step_, 0)};
}

void ContrastPrefilter::lookAtRow(const optics::GreyView& picture, int cell) {
  const Span here = rowsOf(cell);
  const Span next = rowsOf(std::min(cell + 1, cells_ - 1));
  const CellRow row{picture.row(here.top), step_ * picture.stride,
                    picture.row(next.count > 0 ? next.top : here.top), next.count};
  lookAtCells(row, here.count, starts_, dark_.data() + placeOf(cell),
              bright_.data() + kBeside + placeOf(cell));
}

LAB_TARGET_CLONES void ContrastPrefilter::compare(const Levels& levels, int top, int bottom) {
  // Largest difference that noise alone causes between the extremes of a thousand pairs.
  const Bytes by_chance =
      Bytes{} + static_cast<std::uint8_t>(std::min((11 * levels.noise + 7) / 8, 255));
  const Bytes little =
      Bytes{} + static_cast<std::uint8_t>(std::min(levels.black + kLittle * levels.faint, 255));
  const Bytes clear = Bytes{} + static_cast<std::uint8_t>(std::max(levels.clear, 0));
  const auto up = static_cast<std::uint8_t>((std::max(-levels.clear, 0) + 1) / 2);
  const Bytes lift = Bytes{} + up;
  const Bytes most = Bytes{} + levels.most;
  const Bytes black = Bytes{} + levels.black;
  for (int cell = top; cell <= bottom; ++cell) {
    const int first = std::max(cell - 1, 0);
    const int last = std::min(cell + 1, cells_ - 1);
    for (std::size_t word = 0; word < width_; word += kWord) {
      Bytes white{};
      for (int other = first; other <= last; ++other) {
        const std::uint8_t* at = bright_.data() + kBeside + placeOf(other) + word;
        white = brighterOf(
            white, brighterOf(loadBytes(at), brighterOf(loadBytes(at - 1), loadBytes(at + 1))));
      }
      const Bytes half = ((brighterOf(white, clear) - clear) >> 1) + lift;
      const Bytes apart = brighterOf(white, by_chance) - by_chance;
      const Bytes dark = brighterOf(loadBytes(dark_.data() + placeOf(cell) + word), black);
      const auto may = reinterpret_cast<Bytes>(dark <= darkerOf(darkerOf(half, apart), most));
      const auto faint = may & reinterpret_cast<Bytes>(white <= little);
      put(topBits(may), word, words_[(placeOf(cell) + word) / kBits]);
      put(topBits(faint), word, faint_[(placeOf(cell) + word) / kBits]);
    }
  }
}

}  // namespace lab::detector
