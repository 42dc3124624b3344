/// SIMD arithmetic on eight lanes. Internal to the circle fit.
#pragma once

#include <cmath>
#include <cstdint>

#include "tracker_svc/circle_fit/circle_fit_model.hpp"
#include "tracker_svc/detector/saturation.hpp"

#define LAB_INLINE __attribute__((always_inline)) inline
// One clone with AVX2 and FMA, one without. Clang does not pass vectors between functions for
// different processors, and sanitizers do not support the dispatcher (ifunc).
#if defined(__clang__) || defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define LAB_FIT_CLONES
#else
#define LAB_FIT_CLONES __attribute__((target_clones("arch=x86-64-v3", "default")))
#endif

namespace lab::detector::fit {

LAB_INLINE Lanes loadLanes(const float* from) {
  Lanes lanes;
  __builtin_memcpy(&lanes, from, sizeof lanes);
  return lanes;
}

LAB_INLINE Lanes rootOf(const Lanes& v) {
  Lanes out;
  for (int lane = 0; lane < kLanes; ++lane) out[lane] = std::sqrt(v[lane]);
  return out;
}

LAB_INLINE Lanes atLeast(const Lanes& v, float low) {
  const Lanes lows = Lanes{} + low;
  return v > lows ? v : lows;
}

LAB_INLINE Lanes atMost(const Lanes& v, float high) {
  const Lanes highs = Lanes{} + high;
  return v < highs ? v : highs;
}

LAB_INLINE Lanes clamped(const Lanes& v, float low, float high) {
  return atMost(atLeast(v, low), high);
}

LAB_INLINE void storeLanes(float* to, const Lanes& lanes) {
  __builtin_memcpy(to, &lanes, sizeof lanes);
}

/// Converts eight bytes to floats, by shifts in registers: compilers vectorise these, while loading
/// single lanes from memory stalls.
LAB_INLINE Lanes numbers(const std::uint8_t* bytes) {
  typedef std::int64_t Quads __attribute__((vector_size(32)));
  std::int64_t eight;
  __builtin_memcpy(&eight, bytes, sizeof eight);
  const Quads all = Quads{} + eight;
  LaneMask words;
  __builtin_memcpy(&words, &all, sizeof words);
  words = __builtin_shufflevector(words, words, 0, 0, 0, 0, 1, 1, 1, 1);
  constexpr LaneMask kShifts = {0, 8, 16, 24, 0, 8, 16, 24};
  return __builtin_convertvector((words >> kShifts) & 255, Lanes);
}

typedef float Four __attribute__((vector_size(16)));

/// Sums of the lanes of four vectors, always added in the same order.
LAB_INLINE void totals(const Lanes* v, double* out) {
  Four half[4];
#pragma GCC unroll 4
  for (int i = 0; i < 4; ++i) {
    half[i] = __builtin_shufflevector(v[i], v[i], 0, 1, 2, 3) +
              __builtin_shufflevector(v[i], v[i], 4, 5, 6, 7);
  }
  const Four low01 = __builtin_shufflevector(half[0], half[1], 0, 4, 1, 5);
  const Four high01 = __builtin_shufflevector(half[0], half[1], 2, 6, 3, 7);
  const Four low23 = __builtin_shufflevector(half[2], half[3], 0, 4, 1, 5);
  const Four high23 = __builtin_shufflevector(half[2], half[3], 2, 6, 3, 7);
  const Four sum01 = low01 + high01;
  const Four sum23 = low23 + high23;
  const Four sum = __builtin_shufflevector(sum01, sum23, 0, 1, 4, 5) +
                   __builtin_shufflevector(sum01, sum23, 2, 3, 6, 7);
#pragma GCC unroll 4
  for (int i = 0; i < 4; ++i) out[i] = static_cast<double>(sum[i]);
}

/// Sum of the lanes, added in the same order.
LAB_INLINE double total(const Lanes& v) {
  const float a = (v[0] + v[4]) + (v[2] + v[6]);
  const float b = (v[1] + v[5]) + (v[3] + v[7]);
  return static_cast<double>(a + b);
}

/// total() of each of several vectors.
template <std::size_t kCount>
LAB_INLINE void totalEach(const Lanes (&v)[kCount], double* out) {
  constexpr std::size_t kFours = kCount / 4 * 4;
#pragma GCC unroll 40
  for (std::size_t i = 0; i < kFours; i += 4) totals(v + i, out + i);
  if constexpr (kFours < kCount) {
    for (std::size_t i = kFours; i < kCount; ++i) out[i] = total(v[i]);
  }
}

/// Phi(z) and its derivative: odd polynomial of degree 11 on [-3, 3], fitted by least squares,
/// error 5e-5 (derivative 2e-3); constant outside.
LAB_INLINE void edgeProfile(const Lanes& z, Lanes& share, Lanes& slope) {
  constexpr float kEnd = 3.0F;
  constexpr float kC[6] = {0.39874916F,     -0.065853863F, 0.0093591116F,
                           -0.00092187574F, 5.48147e-5F,   -1.4486048e-6F};
  const Lanes near = clamped(z, -kEnd, kEnd);
  // Pairs of terms first: a shorter dependency chain than Horner's, which determines the time here.
  const Lanes q = near * near;
  const Lanes q2 = q * q;
  const Lanes q4 = q2 * q2;
  const Lanes odd = (kC[0] + q * kC[1]) + q2 * (kC[2] + q * kC[3]) + q4 * (kC[4] + q * kC[5]);
  share = 0.5F + near * odd;
  const Lanes even = (kC[0] + q * (3 * kC[1])) + q2 * (5 * kC[2] + q * (7 * kC[3])) +
                     q4 * (9 * kC[4] + q * (11 * kC[5]));
  slope = near == z ? even : Lanes{};
}

template <std::size_t kCount>
struct LaneSums {
  static constexpr std::size_t kPairs = kCount * (kCount + 1) / 2;
  Lanes normal[kPairs] = {};
  Lanes right[kCount] = {};
  Lanes squares = {};

  LAB_INLINE void add(const Lanes* slopes, const Lanes& residual, const Lanes& weights) {
    std::size_t pair = 0;
#pragma GCC unroll 16
    for (std::size_t i = 0; i < kCount; ++i) {
      const Lanes weighted = slopes[i] * weights;
      right[i] += weighted * residual;
#pragma GCC unroll 16
      for (std::size_t j = 0; j <= i; ++j) normal[pair++] += weighted * slopes[j];
    }
    squares += weights * residual * residual;
  }

  LAB_INLINE void writeTo(Sums<kCount>& sums) const {
    totalEach(normal, sums.normal.data());
    totalEach(right, sums.right.data());
    sums.squares = total(squares);
  }
};

/// Per-pixel counts.
struct LaneCounts {
  Lanes weight = {};
  Lanes pixels = {};
  Lanes cost = {};
  Lanes full = {};

  LAB_INLINE void writeTo(Counts& counts) const {
    counts.weight = total(weight);
    counts.pixels = total(pixels);
    counts.full = total(full);
  }
};

/// Position of pixels relative to a disc.
struct Offset {
  Lanes z;              ///< [blur sigma] distance beyond the outline
  Lanes over_distance;  ///< [1/px]
  Lanes out_x, out_y;   ///< [px] over_distance times this is the gradient of the distance
};

LAB_INLINE void wayAt(const Lanes& x, const Lanes& y, const Disc& disc, const Constants& constants,
                      float over_sigma, Offset& offset) {
  const Lanes dx = x - disc.x;
  const Lanes dy = y - disc.y;
  const Outline& outline = constants.outline;
  offset.out_x = outline.xx * dx + outline.xy * dy;
  offset.out_y = outline.xy * dx + outline.yy * dy;
  const Lanes distance = rootOf(dx * offset.out_x + dy * offset.out_y + disc.sigma * disc.sigma);
  offset.over_distance = 1.0F / distance;
  offset.z = (distance - constants.radius * disc.scale) * over_sigma;
}

/// The blurred paint at the pixels.
struct Paint : Offset {
  Lanes share;  ///< 0 black, 1 white
  Lanes slope;  ///< d share / d z
};

LAB_INLINE void paintAt(const Lanes& x, const Lanes& y, const Disc& disc,
                        const Constants& constants, float over_sigma, Paint& paint) {
  wayAt(x, y, disc, constants, over_sigma, paint);
  edgeProfile(paint.z, paint.share, paint.slope);
}

/// Tukey's biweight: 1 for small residuals, 0 beyond the cutoff.
LAB_INLINE Lanes tukeyWeight(const Lanes& square, float over_cutoff) {
  const Lanes far = atLeast(1.0F - square * over_cutoff, 0.0F);
  return far * far;
}

LAB_INLINE Lanes varianceOf(const Lanes& signal, const Constants& constants) {
  const Lanes lit = atLeast(signal, 0.0F);
  return constants.floor_variance + lit * (constants.shot_gain + lit * constants.texture);
}

/// 1 / expected variance; 0 for missing or saturated pixels.
LAB_INLINE Lanes inverseVarianceOf(const Lanes& value, const Lanes& signal,
                                   const Constants& constants, LaneCounts& counts) {
  const Lanes expected = signal + constants.black;
  const Lanes variance = varianceOf(signal, constants);
  // A saturated pixel is not used. The model's value decides as well as the pixel's, because a
  // selection by the measured value alone would bias the result.
  const LaneMask some = value != kNoPixel;
  const LaneMask full = some & (expected > kSaturated) & (value > kNearlySaturated);
  const LaneMask use = some & ~full;
  counts.full += full ? Lanes{} + 1.0F : Lanes{};
  counts.pixels += use ? Lanes{} + 1.0F : Lanes{};
  return use ? 1.0F / variance : Lanes{};
}

/// Cost whose derivative is residual times tukeyWeight(), with the cutoff kLimit.
LAB_INLINE Lanes tukeyCost(const Lanes& square) {
  const Lanes limited = atLeast(1.0F - square * (1.0F / (kLimit * kLimit)), 0.0F);
  return (1.0F - limited * limited * limited) * (kLimit * kLimit / 3.0F);
}

}  // namespace lab::detector::fit
