#pragma once

#include <array>
#include <cstdint>

namespace lab::analysis {

/// xoshiro256++ seeded by SplitMix64 (Blackman and Vigna 2019), for simulated recordings. Not
/// common/math/random.hpp: results must keep their bits, and this one has a fast normal().
class Random {
 public:
  explicit Random(std::uint64_t seed);

  std::uint64_t next();
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }  ///< In [0, 1).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  double exponential(double rate);  ///< Mean 1 / rate.
  double normal();  ///< Mean 0, variance 1: ziggurat of 128 layers (Marsaglia and Tsang 2000).

 private:
  std::array<std::uint64_t, 4> state_{};
};

}  // namespace lab::analysis
