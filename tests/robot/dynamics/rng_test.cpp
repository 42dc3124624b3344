#include "robot/dynamics/rng.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

namespace lab::dynamics {
namespace {

TEST(Rng, DrawsThePublishedSequence) {
  Rng dut;
  dut.setState(1, 2, 3, 4);
  // The reference implementation's first outputs from the state 1, 2, 3, 4.
  for (const uint32_t expected : {641U, 1573767U, 3222811527U, 3517856514U, 836907274U}) {
    EXPECT_EQ(dut.next(), expected);
  }
}

TEST(Rng, SplitMixDrawsThePublishedSequence) {
  uint64_t state = 1234567;
  EXPECT_EQ(splitMix64(state), 6457827717110365317ULL);
  EXPECT_EQ(splitMix64(state), 3203168211198807973ULL);
}

TEST(Rng, DifferentSeedsGiveDifferentStreams) {
  std::set<uint32_t> firsts;
  for (uint64_t seed = 0; seed < 1000; ++seed) {
    firsts.insert(Rng(seed).next());
  }
  EXPECT_GE(firsts.size(), 999U);
}

TEST(UniformInt, StaysInTheRangeAndReachesBothEnds) {
  Rng rng(7);
  std::set<int32_t> seen;
  for (int i = 0; i < 1000; ++i) {
    seen.insert(uniformInt(rng, 2));
  }
  EXPECT_EQ(seen, (std::set<int32_t>{-2, -1, 0, 1, 2}));
  EXPECT_EQ(uniformInt(rng, 0), 0);
}

TEST(UniformInt, HasTheMomentsOfTheUniformLaw) {
  constexpr int kDraws = 4000000;
  constexpr int32_t kAmplitude = 112500;
  Rng rng(20);
  double sum = 0;
  double sum2 = 0;
  double lagged = 0;
  double previous = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = static_cast<double>(uniformInt(rng, kAmplitude)) / kAmplitude;
    sum += x;
    sum2 += x * x;
    lagged += x * previous;
    previous = x;
  }
  const double n = kDraws;
  EXPECT_LT(std::abs(sum / n) / std::sqrt(1 / 3.0 / n), 4);
  // The variance of x^2 is 1/5 - 1/9.
  EXPECT_LT(std::abs(sum2 / n - 1 / 3.0) / std::sqrt(4 / 45.0 / n), 4);
  EXPECT_LT(std::abs(lagged / n) / (1 / 3.0 / std::sqrt(n)), 4);
}

TEST(UniformInt, IsUniformOverCells) {
  constexpr int kCells = 101;
  constexpr int kDraws = 1010000;
  Rng rng(3);
  std::vector<double> count(kCells);
  for (int i = 0; i < kDraws; ++i) {
    ++count[static_cast<size_t>(uniformInt(rng, 50) + 50)];
  }
  double chi2 = 0;
  const double expected = static_cast<double>(kDraws) / kCells;
  for (const double c : count) {
    chi2 += (c - expected) * (c - expected) / expected;
  }
  const double dof = kCells - 1;
  EXPECT_LT(std::abs(chi2 - dof) / std::sqrt(2 * dof), 4);
}

TEST(Rng, DigestChangesWithEveryBitOfTheState) {
  Rng rng;
  rng.setState(0x12345678, 0x9ABCDEF0, 0x0F1E2D3C, 0x4B5A6978);
  const uint32_t digest = rng.digest();
  EXPECT_EQ(digest, 0x12345678U ^ 0xBCDEF09AU ^ 0x2D3C0F1EU ^ 0x784B5A69U);
  for (uint8_t bit = 0; bit < 128; ++bit) {
    uint32_t words[4] = {0x12345678, 0x9ABCDEF0, 0x0F1E2D3C, 0x4B5A6978};
    words[bit / 32] ^= 1U << (bit % 32);
    rng.setState(words[0], words[1], words[2], words[3]);
    EXPECT_NE(rng.digest(), digest) << int{bit};
  }
}

}  // namespace
}  // namespace lab::dynamics
