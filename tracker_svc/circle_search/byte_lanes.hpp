/// SIMD arithmetic on 32 pixels at once, as two halves of 16 on processors without AVX2. Internal
/// to the search.
#pragma once

#include <emmintrin.h>

#include <cstdint>
#include <cstring>

#include "tracker_svc/circle_search/dark_pixels.hpp"

namespace lab::detector {

using Bytes = std::uint8_t __attribute__((vector_size(kWord)));

[[gnu::always_inline]] inline Bytes loadBytes(const std::uint8_t* from) {
  Bytes bytes;
  std::memcpy(&bytes, from, sizeof bytes);
  return bytes;
}

[[gnu::always_inline]] inline Bytes brighterOf(const Bytes& a, const Bytes& b) {
  return a > b ? a : b;
}

[[gnu::always_inline]] inline Bytes darkerOf(const Bytes& a, const Bytes& b) {
  return a < b ? a : b;
}

/// Bit mask of the bytes with their top bit set.
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

}  // namespace lab::detector
