#include "runner/live/rate_limit.hpp"

#include <gtest/gtest.h>

#include <cstdint>

namespace lab::runner::rate_limit_test {
namespace {

TEST(RateLimit, AllowsABurstAndThenItsRate) {
  RateLimit dut(10, 1'000'000);
  const auto allowed = [&dut](std::int64_t from, std::int64_t until) {
    int count = 0;
    for (std::int64_t now = from; now < until; now += 1000) count += dut.allows(now) ? 1 : 0;
    return count;
  };
  EXPECT_EQ(allowed(5'000'000, 5'010'000), 10);
  EXPECT_NEAR(allowed(5'010'000, 15'010'000), 100, 1);
  EXPECT_TRUE(dut.allows(20'000'000));
}

}  // namespace
}  // namespace lab::runner::rate_limit_test
