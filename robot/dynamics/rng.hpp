#pragma once

#include <stdint.h>

namespace lab {
namespace dynamics {

/// One step of SplitMix64 (Steele, Lea, Flood 2014): advances `state` and returns 64 mixed bits.
inline uint64_t splitMix64(uint64_t& state) {
  state += 0x9E3779B97F4A7C15ULL;
  uint64_t z = state;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31);
}

/// The generator xoshiro128++ 1.0 (Blackman and Vigna 2021): 16 bytes of state, 32-bit operations
/// only, period 2^128 - 1. It draws the same bits on the robot and on the host.
class Rng {
 public:
  Rng() { seed(0); }
  explicit Rng(uint64_t seed_value) { seed(seed_value); }

  /// Fills the state from one number by SplitMix64; no seed gives the forbidden all-zero state.
  void seed(uint64_t seed_value) {
    for (int i = 0; i < 4; i += 2) {
      const uint64_t bits = splitMix64(seed_value);
      state_[i] = static_cast<uint32_t>(bits);
      state_[i + 1] = static_cast<uint32_t>(bits >> 32);
    }
  }

  /// Sets the state itself, for comparing with published sequences; all four zero is not allowed.
  void setState(uint32_t s0, uint32_t s1, uint32_t s2, uint32_t s3) {
    state_[0] = s0;
    state_[1] = s1;
    state_[2] = s2;
    state_[3] = s3;
  }

  /// One word of the state (index 0..3), for logs from which the draws can be repeated.
  uint32_t stateWord(uint8_t index) const { return state_[index & 3U]; }

  /// A 32-bit digest of the state, to compare the draws of two runs.
  uint32_t digest() const {
    return state_[0] ^ rotateLeft(state_[1], 8) ^ rotateLeft(state_[2], 16) ^
           rotateLeft(state_[3], 24);
  }

  /// 32 uniform random bits.
  uint32_t next() {
    const uint32_t result = rotateLeft(state_[0] + state_[3], 7) + state_[0];
    const uint32_t shifted = state_[1] << 9;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= shifted;
    state_[3] = rotateLeft(state_[3], 11);
    return result;
  }

 private:
  static uint32_t rotateLeft(uint32_t x, uint8_t bits) { return (x << bits) | (x >> (32U - bits)); }

  uint32_t state_[4];
};

}  // namespace dynamics
}  // namespace lab
