#include "robot_bridge/protocol/clock_estimate.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/math/random.hpp"

namespace lab::bridge {
namespace {

constexpr std::int64_t kStart = 1'700'000'000'000'000;
constexpr std::int64_t kSecond_us = 1'000'000;
constexpr std::int64_t kRequest_us = 4'427;  // 17 bytes at 38400 baud
constexpr std::int64_t kAnswer_us = 5'990;   // 23 bytes

/// A robot's clock, and a line with occasional delays.
struct Robot {
  double rate = 1;                ///< robot seconds per host second
  std::uint64_t start_ms = 5000;  ///< reading at kStart
  Random random{1};
  double longest_delay_us = 0;

  [[nodiscard]] double robotUs(double host_us) const {
    return static_cast<double>(start_ms) * 1000 + rate * host_us;
  }
  /// The robot's 32-bit milliseconds.
  [[nodiscard]] std::uint32_t ms(double host_us) const {
    return static_cast<std::uint32_t>(static_cast<std::uint64_t>(robotUs(host_us) / 1000));
  }
  /// A round trip that begins at this time after kStart.
  void ping(ClockEstimate& clock, double host_us) {
    const double there =
        host_us + static_cast<double>(kRequest_us) + random.uniform() * longest_delay_us;
    const double back =
        there + static_cast<double>(kAnswer_us) + random.uniform() * longest_delay_us;
    const auto reading = static_cast<std::uint64_t>(robotUs(there));
    const std::uint64_t wrapped = (reading / 1000 % (1ULL << 32U)) * 1000 + reading % 1000;
    clock.add(kStart + std::llround(host_us), kStart + std::llround(back), wrapped, kRequest_us,
              kAnswer_us);
  }
  /// Error of the estimate for the reading at this time, without the rounding to milliseconds [us].
  [[nodiscard]] double error(const ClockEstimate& clock, double host_us) const {
    const double true_us = (std::floor(robotUs(host_us) / 1000) * 1000 - robotUs(0)) / rate;
    return static_cast<double>(clock.utimeOf(ms(host_us)) - kStart) - true_us;
  }
};

TEST(ClockEstimate, IsUnknownAtFirst) {
  const ClockEstimate dut;
  EXPECT_FALSE(dut.known());
  EXPECT_EQ(dut.utimeOf(1234), 0);
}

TEST(ClockEstimate, OneRoundTripOnAnIdleLineGivesTheOffset) {
  ClockEstimate dut;
  Robot robot;
  robot.ping(dut, 0);
  EXPECT_NEAR(robot.error(dut, 50'000), 0, 2);
  EXPECT_EQ(dut.rate(), 1);
}

TEST(ClockEstimate, FindsTheDrift) {
  for (const double rate : {0.995, 1.0, 1.005}) {
    ClockEstimate dut;
    Robot robot;
    robot.rate = rate;
    robot.longest_delay_us = 10'000;
    for (int i = 0; i < 60; ++i) robot.ping(dut, i * 1e6);
    EXPECT_NEAR(dut.rate() * rate, 1, 1e-4);
    EXPECT_NEAR(robot.error(dut, 60e6), 0, 3'000);
    EXPECT_NEAR(robot.error(dut, 30e6), 0, 3'000);
  }
}

TEST(ClockEstimate, ErrorIsNeverAboveTheClaimedUncertainty) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    ClockEstimate dut;
    Robot robot;
    robot.random = Random(seed);
    robot.rate = 1 + 0.01 * (robot.random.uniform() - 0.5);
    robot.longest_delay_us = 20'000 * robot.random.uniform();
    for (int i = 0; i < 40; ++i) {
      const double t = i < 10 ? 0.2e6 * i : 1e6 * (i - 8);
      robot.ping(dut, t);
      const double soon = t + 0.15e6;
      EXPECT_LE(std::abs(robot.error(dut, soon)), dut.uncertainty(robot.ms(soon)) + 2)
          << "seed " << seed << ", round trip " << i;
    }
  }
}

TEST(ClockEstimate, WrapsAround) {
  ClockEstimate dut;
  Robot robot;
  robot.start_ms = (1ULL << 32U) - 5'000;
  for (int i = 0; i < 10; ++i) robot.ping(dut, i * 1e6);
  EXPECT_NEAR(robot.error(dut, 10e6), 0, 50);
  EXPECT_NEAR(robot.error(dut, 2e6), 0, 50) << "before the wrap";
}

TEST(ClockEstimate, WorksOverManyWraps) {
  ClockEstimate dut;
  Robot robot;
  const double day_us = 86400e6;
  for (int day = 0; day < 120; day += 10) {
    for (int i = 0; i < 10; ++i) robot.ping(dut, day * day_us + i * 1e6);
    EXPECT_NEAR(robot.error(dut, day * day_us + 10e6), 0, 50) << "day " << day;
  }
}

TEST(ClockEstimate, UsesUnsolicitedReadingsUntilTheFirstRoundTrip) {
  ClockEstimate dut;
  dut.addReading(kStart + 30'000, 1000, 10'000);
  EXPECT_EQ(dut.utimeOf(1000), kStart + 20'000);
  dut.addReading(kStart + 65'000, 1050, 10'000);  // shorter delay
  EXPECT_EQ(dut.utimeOf(1050), kStart + 55'000);
  dut.addReading(kStart + 150'000, 1100, 10'000);  // longer delay
  EXPECT_EQ(dut.utimeOf(1050), kStart + 55'000);
  Robot robot;
  robot.start_ms = 2000;
  robot.ping(dut, 1e6);
  EXPECT_NEAR(robot.error(dut, 1.1e6), 0, 2);
  dut.addReading(kStart, 3000, 0);  // ignored
  EXPECT_NEAR(robot.error(dut, 1.1e6), 0, 2);
}

TEST(ClockEstimate, ForgetsARobotThatRestarted) {
  ClockEstimate dut;
  Robot robot;
  for (int i = 0; i < 5; ++i) robot.ping(dut, i * 1e6);
  dut.reset();
  EXPECT_FALSE(dut.known());
  Robot restarted;
  restarted.start_ms = 0;
  restarted.ping(dut, 10e6);
  EXPECT_NEAR(restarted.error(dut, 10.1e6), 0, 2);
}

}  // namespace
}  // namespace lab::bridge
