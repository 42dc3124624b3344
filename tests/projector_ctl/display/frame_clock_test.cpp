#include "projector_ctl/display/frame_clock.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace lab::projector {
namespace {

constexpr std::int64_t kSomeDay = 1'763'715'600'000'000;  // a whole second [us since 1970]

TEST(FrameClock, RoundsEachBoundaryToTheNearestMicrosecond) {
  const FrameClock dut(60);
  EXPECT_EQ(dut.boundary(0), 0);
  EXPECT_EQ(dut.boundary(1), 16'667);
  EXPECT_EQ(dut.boundary(2), 33'333);
  EXPECT_EQ(dut.boundary(3), 50'000);
}

TEST(FrameClock, HasExactlySixtyFramesInEverySecondOfToday) {
  const FrameClock dut(60);
  const std::int64_t first = dut.numberAtOrAfter(kSomeDay);
  EXPECT_EQ(dut.boundary(first), kSomeDay);
  for (std::int64_t second = 1; second <= 5000; ++second) {
    ASSERT_EQ(dut.boundary(first + 60 * second), kSomeDay + second * 1'000'000);
  }
}

TEST(FrameClock, FindsTheFirstBoundaryAtOrAfterATime) {
  const FrameClock dut(60);
  EXPECT_EQ(dut.nextBoundary(kSomeDay), kSomeDay);
  EXPECT_EQ(dut.nextBoundary(kSomeDay + 1), kSomeDay + 16'667);
  EXPECT_EQ(dut.nextBoundary(kSomeDay + 16'667), kSomeDay + 16'667);
  EXPECT_EQ(dut.nextBoundary(kSomeDay + 16'668), kSomeDay + 33'333);
}

TEST(FrameClock, BoundariesAndNumbersCorrespondAtAnyRate) {
  for (const double rate : {1.0, 23.976, 59.94, 60.0, 120.0, 1000.0}) {
    const FrameClock dut(rate);
    const std::int64_t first = dut.numberAtOrAfter(kSomeDay);
    for (std::int64_t number = first; number < first + 200; ++number) {
      ASSERT_EQ(dut.numberAtOrAfter(dut.boundary(number)), number) << rate << " Hz";
      ASSERT_EQ(dut.numberAtOrAfter(dut.boundary(number) - 1), number) << rate << " Hz";
      ASSERT_EQ(dut.numberAtOrAfter(dut.boundary(number) + 1), number + 1) << rate << " Hz";
    }
  }
}

TEST(FrameClock, RefusesARateOutOfRange) {
  EXPECT_THROW(FrameClock(0), std::invalid_argument);
  EXPECT_THROW(FrameClock(1e6), std::invalid_argument);
  EXPECT_THROW(FrameClock(std::nan("")), std::invalid_argument);
}

}  // namespace
}  // namespace lab::projector
