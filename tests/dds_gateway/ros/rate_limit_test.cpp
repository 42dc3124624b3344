#include "dds_gateway/ros/rate_limit.hpp"

#include <gtest/gtest.h>

namespace lab::gateway {
namespace {

int admitted(RateLimit& dut, std::int64_t from, std::int64_t period, int count) {
  int passed = 0;
  for (int i = 0; i < count; ++i) passed += dut.admit(from + i * period) ? 1 : 0;
  return passed;
}

TEST(RateLimit, ARateOfZeroPassesAll) {
  RateLimit dut(0);
  EXPECT_EQ(admitted(dut, 0, 1, 100), 100);
}

TEST(RateLimit, KeepsTheMeanRate) {
  RateLimit five(5);
  EXPECT_EQ(admitted(five, 1'000'000'000, 16'667, 600), 50);  // 60 Hz for 10 s
  RateLimit seven(7);
  EXPECT_EQ(admitted(seven, 1'000'000'000, 20'000, 500), 70);  // 7 Hz does not divide 50 Hz
}

TEST(RateLimit, LetsSlowMessagesPass) {
  RateLimit dut(5);
  EXPECT_EQ(admitted(dut, 0, 250'000, 40), 40);
}

TEST(RateLimit, DoesNotCatchUpAfterAPause) {
  RateLimit dut(10);
  EXPECT_TRUE(dut.admit(0));
  EXPECT_TRUE(dut.admit(10'000'000));
  EXPECT_FALSE(dut.admit(10'000'001));
  EXPECT_FALSE(dut.admit(10'099'999));
  EXPECT_TRUE(dut.admit(10'100'000));
}

TEST(RateLimit, RestartsWhenTimeJumpsBack) {
  RateLimit dut(1);
  EXPECT_TRUE(dut.admit(50'000'000));
  EXPECT_TRUE(dut.admit(10'000'000));
  EXPECT_FALSE(dut.admit(10'500'000));
  EXPECT_TRUE(dut.admit(11'000'000));
}

}  // namespace
}  // namespace lab::gateway
