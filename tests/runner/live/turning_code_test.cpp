#include "runner/live/turning_code.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace lab::runner {
namespace {

int smallestDistance(const TurningCode& code) {
  int smallest = code.rounds;
  for (std::size_t i = 0; i < code.words.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      smallest = std::min(smallest, std::popcount(code.words[i] ^ code.words[j]));
    }
  }
  return smallest;
}

TEST(TurningCode, AnyTwoWordsDifferInFourRounds) {
  for (const std::size_t robots : {2U, 14U, 100U, 200U, 250U, 1000U}) {
    const TurningCode code = turningCode(robots);
    EXPECT_EQ(code.words.size(), robots);
    EXPECT_GE(smallestDistance(code), 4) << robots;
  }
}

TEST(TurningCode, HasAFewRoundsMoreThanTheLogarithm) {
  for (std::size_t robots = 8; robots <= 4096; robots = robots * 5 / 4) {
    const int logarithm = static_cast<int>(std::ceil(std::log2(static_cast<double>(robots))));
    EXPECT_LE(turningCode(robots).rounds, logarithm + 6) << robots;
  }
  EXPECT_EQ(turningCode(200).rounds, 13);
  EXPECT_EQ(turningCode(1).rounds, 8);
}

TEST(TurningCode, EveryWordReverses) {
  const TurningCode code = turningCode(250);
  for (const std::uint32_t word : code.words) {
    int reversals = 0;
    for (int i = 1; i < code.rounds; ++i) {
      if ((((word >> i) ^ (word >> (i - 1))) & 1) != 0) ++reversals;
    }
    EXPECT_GE(reversals, kFewestReversals) << word;
    EXPECT_LT(word, 1U << code.rounds);
  }
}

}  // namespace
}  // namespace lab::runner
