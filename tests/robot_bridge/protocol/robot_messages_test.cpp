#include "robot_bridge/protocol/robot_messages.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>

namespace lab::bridge {
namespace {

/// A clock with the reading `ms` at `utime` and this rate [host seconds per robot second].
ClockEstimate clockOf(std::uint32_t ms, std::int64_t utime, double rate) {
  ClockEstimate clock;
  for (int i = 20; i >= 0; --i) {
    const auto host = utime - static_cast<std::int64_t>(i * 1e6 * rate);
    clock.add(host, host, std::uint64_t{ms - static_cast<std::uint32_t>(i) * 1000} * 1000, 0, 0);
  }
  return clock;
}

TEST(ReportHistory, ATimeFollowsTheClockAtFirstAndIsThenFixed) {
  ReportHistory::Time dut;
  const std::int64_t first = dut.at(clockOf(100'000, 1'000'000'000, 1), 100'000, 100'000);
  EXPECT_EQ(first, 1'000'000'000);
  const std::int64_t better = dut.at(clockOf(102'000, 1'002'010'000, 1), 100'000, 102'000);
  EXPECT_NEAR(static_cast<double>(better), 1'000'010'000, 2);
  const ClockEstimate later = clockOf(4'100'000, 5'001'000'000, 1.0001);
  EXPECT_GT(std::abs(later.utimeOf(100'000) - better), 100'000) << "extrapolated over an hour";
  EXPECT_EQ(dut.at(later, 100'000, 4'100'000), better);
  EXPECT_EQ(dut.at(later, 4'000'000, 4'100'000), later.utimeOf(4'000'000)) << "another event";
}

TEST(ReportHistory, RunTimeNeverDecreasesWhenTheRateChanges) {
  ReportHistory dut;
  EXPECT_DOUBLE_EQ(dut.runTime(3'600'000, 1.001), 3603.6);
  EXPECT_DOUBLE_EQ(dut.runTime(3'600'000, 0.999), 3603.6);
  EXPECT_DOUBLE_EQ(dut.runTime(3'601'000, 1), 3604.6);
  EXPECT_DOUBLE_EQ(dut.runTime(500, 1), 0.5) << "after a restart";
}

TEST(ReportHistory, ReportsASaturationOnce) {
  ReportHistory dut;
  EXPECT_FALSE(dut.saturated(0));
  EXPECT_TRUE(dut.saturated(3));
  EXPECT_FALSE(dut.saturated(3));
}

}  // namespace
}  // namespace lab::bridge
