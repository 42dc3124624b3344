#include "analyzer/curves/clock_error.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lab::analysis::clock_error_test {
namespace {

Estimate holdOf(double sigma) {
  return {"epsilon", "s", 0.5, sigma, 0.5 - 2 * sigma, 0.5 + 2 * sigma, 0.5, 100, ""};
}

TEST(ClockError, IsAddedToTheStandardErrorAndTheInterval) {
  Estimate dut = holdOf(0.002);
  widenByClocks(dut, 1);
  EXPECT_NEAR(dut.sigma, std::hypot(0.002, 0.5 * 0.005), 1e-12);
  EXPECT_NEAR(std::log(dut.high95 / dut.value),
              std::log(0.504 / 0.5) * std::hypot(0.002, 0.0025) / 0.002, 1e-12);
  EXPECT_EQ(dut.value, 0.5);
}

TEST(ClockError, OfManyRobotsIsSmaller) {
  Estimate dut = holdOf(0.0001);
  widenByClocks(dut, 25);
  EXPECT_NEAR(dut.sigma, std::hypot(0.0001, 0.0005), 1e-12);
}

TEST(ClockError, DoesNotConcernSpeedsAndWhatIsNotKnown) {
  Estimate speed = holdOf(0.002);
  widenByClocks(speed, 1, 0);
  EXPECT_EQ(speed.sigma, 0.002);
  EXPECT_EQ(speed.low95, holdOf(0.002).low95);
  Estimate exact = holdOf(0);
  widenByClocks(exact, 1);
  EXPECT_EQ(exact.sigma, 0);
}

TEST(ClockError, KeepsTheMiddleOfAnIntervalAroundZero) {
  Estimate dut{"D", "m^2/s", 0.1, 1, -1.9, 2.1, 0.1, 10, ""};
  widenByClocks(dut, 1);
  EXPECT_NEAR(dut.low95 + dut.high95, 0.2, 1e-12);
  EXPECT_GE(dut.high95, 2.1);
}

}  // namespace
}  // namespace lab::analysis::clock_error_test
