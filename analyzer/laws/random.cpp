#include "analyzer/laws/random.hpp"

#include <bit>
#include <cmath>

namespace lab::analysis {
namespace {

/// 128 layers of equal area under exp(-x^2/2).
struct Ziggurat {
  static constexpr double kTail = 3.442619855899;
  std::array<double, 129> edge{};    ///< Right edges, widest (the base's virtual one) first.
  std::array<double, 129> height{};  ///< exp(-x^2/2) at them.

  Ziggurat() {
    constexpr double kArea = 9.91256303526217e-3;
    const auto density = [](double x) { return std::exp(-0.5 * x * x); };
    edge[0] = kArea / density(kTail);
    edge[1] = kTail;
    for (std::size_t i = 2; i < 128; ++i) {
      edge[i] = std::sqrt(-2 * std::log(kArea / edge[i - 1] + density(edge[i - 1])));
    }
    edge[128] = 0;
    for (std::size_t i = 0; i < 129; ++i) height[i] = density(edge[i]);
  }
};

const Ziggurat kZiggurat;

}  // namespace

Random::Random(std::uint64_t seed) {
  for (std::uint64_t& word : state_) {
    seed += 0x9E3779B97F4A7C15ULL;
    std::uint64_t z = seed;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    word = z ^ (z >> 31);
  }
}

std::uint64_t Random::next() {
  const std::uint64_t result = std::rotl(state_[0] + state_[3], 23) + state_[0];
  const std::uint64_t shifted = state_[1] << 17;
  state_[2] ^= state_[0];
  state_[3] ^= state_[1];
  state_[1] ^= state_[2];
  state_[0] ^= state_[3];
  state_[2] ^= shifted;
  state_[3] = std::rotl(state_[3], 45);
  return result;
}

double Random::exponential(double rate) { return -std::log1p(-uniform()) / rate; }

double Random::normal() {
  for (;;) {
    const std::uint64_t bits = next();
    const std::size_t layer = bits & 127;
    const double u = static_cast<double>(static_cast<std::int64_t>(bits) >> 10) * 0x1.0p-53;
    const double x = u * kZiggurat.edge[layer];
    if (std::abs(x) < kZiggurat.edge[layer + 1]) return x;
    if (layer == 0) {  // the tail, after Marsaglia
      double beyond = 0;
      double height = 0;
      do {
        beyond = exponential(Ziggurat::kTail);
        height = exponential(1);
      } while (2 * height < beyond * beyond);
      return u < 0 ? -Ziggurat::kTail - beyond : Ziggurat::kTail + beyond;
    }
    const double low = kZiggurat.height[layer];
    const double high = kZiggurat.height[layer + 1];
    if (low + uniform() * (high - low) < std::exp(-0.5 * x * x)) return x;
  }
}

}  // namespace lab::analysis
