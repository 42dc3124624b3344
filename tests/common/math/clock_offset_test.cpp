#include "common/math/clock_offset.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/math/random.hpp"

namespace lab::clock_offset_test {
namespace {

constexpr std::int64_t kStart = 1'700'000'000'000'000;

/// A round trip with two delays; the other clock is ahead by `offset` [us].
void roundTrip(ClockOffsetEstimator& clock, std::int64_t start, std::int64_t there,
               std::int64_t thinks, std::int64_t back, std::int64_t offset) {
  clock.add(start, start + there + offset, start + there + thinks + offset,
            start + there + thinks + back);
}

TEST(ClockOffsetEstimator, GivesNoResultBeforeEnoughRoundTrips) {
  ClockOffsetEstimator clock;
  for (std::size_t i = 0; i + 1 < ClockOffsetEstimator::kEnough; ++i)
    roundTrip(clock, kStart, 100, 10, 100, 0);
  EXPECT_TRUE(std::isnan(clock.estimate().offset));
  roundTrip(clock, kStart, 100, 10, 100, 0);
  EXPECT_EQ(clock.estimate().offset, 0);
}

TEST(ClockOffsetEstimator, EqualDelaysGiveTheExactOffset) {
  for (const std::int64_t offset : {-7'000'000'000L, -12345L, 0L, 1L, 5000000L}) {
    ClockOffsetEstimator clock;
    for (int i = 0; i < 8; ++i) roundTrip(clock, kStart + i, 250, 40, 250, offset);
    EXPECT_DOUBLE_EQ(clock.estimate().offset, 1e-6 * static_cast<double>(offset));
    EXPECT_DOUBLE_EQ(clock.estimate().error, 250e-6);
    EXPECT_DOUBLE_EQ(clock.estimate().round_trip, 500e-6);
  }
}

TEST(ClockOffsetEstimator, TheTrueOffsetIsWithinTheErrorForAnyDelays) {
  Random random(7);
  for (int trial = 0; trial < 2000; ++trial) {
    ClockOffsetEstimator clock;
    const auto offset = static_cast<std::int64_t>(1e5 * random.normal());
    for (int i = 0; i < 20; ++i) {
      const auto way = [&] {
        return static_cast<std::int64_t>(100 - 3000 * std::log(1 - random.uniform()));
      };
      roundTrip(clock, kStart + i * 100'000, way(), way(), way(), offset);
    }
    const ClockOffset estimate = clock.estimate();
    EXPECT_LE(std::abs(estimate.offset - 1e-6 * static_cast<double>(offset)),
              estimate.error + 1e-12);
  }
}

TEST(ClockOffsetEstimator, TheFastestRoundTripCountsAndOldOnesAreForgotten) {
  ClockOffsetEstimator clock;
  for (int i = 0; i < 8; ++i) roundTrip(clock, kStart + i * 1000, 20'000, 0, 100, 0);
  EXPECT_GT(clock.estimate().offset, 5e-3);
  roundTrip(clock, kStart + 9000, 100, 0, 100, 0);
  EXPECT_EQ(clock.estimate().offset, 0);
  EXPECT_DOUBLE_EQ(clock.estimate().error, 100e-6);
  // The round trip leaves the window, by number and by age.
  for (std::size_t i = 0; i < ClockOffsetEstimator::kWindow; ++i)
    roundTrip(clock, kStart + 10'000, 500, 0, 500, 0);
  EXPECT_DOUBLE_EQ(clock.estimate().error, 500e-6);
  for (std::size_t i = 0; i < ClockOffsetEstimator::kEnough; ++i) {
    roundTrip(clock, kStart + 60'000'000, 900, 0, 900, 0);
    EXPECT_FALSE(std::isnan(clock.estimate().offset));
  }
  EXPECT_DOUBLE_EQ(clock.estimate().error, 900e-6);
}

TEST(ClockOffsetEstimator, ImpossibleTimesAreIgnored) {
  ClockOffsetEstimator clock;
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  for (int i = 0; i < 20; ++i) {
    clock.add(kStart, kStart, kStart, kStart - 1);         // an answer before the request
    clock.add(kStart, kStart, kStart - 1, kStart + 10);    // left before it arrived
    clock.add(kStart, kStart, kStart + 100, kStart + 10);  // longer there than the whole round trip
    clock.add(kStart, -kMost, kMost, kStart + 10);
    clock.add(-kMost, kStart, kStart, kMost);
    clock.add(0, 0, 0, 0);
  }
  EXPECT_TRUE(std::isnan(clock.estimate().offset));
}

}  // namespace
}  // namespace lab::clock_offset_test
