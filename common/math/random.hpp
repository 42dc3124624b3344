/// Random numbers. The experiment file has one seed, from which every stream is derived.
#pragma once

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <numbers>
#include <string_view>

namespace lab {

/// One round of splitmix64 (Steele, Lea, Flood 2014): a bijection that mixes every bit.
constexpr std::uint64_t mix64(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15U;
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31U);
}

/// The seed of the stream for `purpose` of `owner` (such as a robot's id). Different owners and
/// purposes get independent streams, so adding a robot does not change the others' random streams.
constexpr std::uint64_t deriveSeed(std::uint64_t seed, std::int64_t owner,
                                   std::string_view purpose) {
  std::uint64_t hash = mix64(seed);
  hash = mix64(hash ^ static_cast<std::uint64_t>(owner));
  for (const char letter : purpose) {
    hash = mix64(hash ^ static_cast<std::uint64_t>(static_cast<unsigned char>(letter)));
  }
  return hash;
}

/// A stream of random numbers (splitmix64). Unlike the standard library's distributions, it gives
/// the same numbers on every machine.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(mix64(seed)) {}
  Random(std::uint64_t seed, std::uint64_t stream) : state_(mix64(mix64(seed) ^ stream)) {}

  std::uint64_t next() {
    const std::uint64_t value = mix64(state_);
    state_ += 0x9e3779b97f4a7c15U;
    return value;
  }

  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(next() >> 11U) * 0x1.0p-53; }

  /// Standard normal (Box and Muller 1958).
  double normal() {
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    return radius * std::cos(2 * std::numbers::pi * uniform());
  }

 private:
  std::uint64_t state_;
};

}  // namespace lab
