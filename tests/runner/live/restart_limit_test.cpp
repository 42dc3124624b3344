#include "runner/live/restart_limit.hpp"

#include <gtest/gtest.h>

#include <cstdint>

#include "common/math/units.hpp"

namespace lab::runner::restart_limit_test {
namespace {

using units::kSecond_us;

TEST(RestartLimit, RestartsAtOnceAndThenWithDoublingPauses) {
  RestartLimit dut;
  for (const std::int64_t pause_us : {0, 500'000, 1'000'000, 2'000'000, 4'000'000}) {
    EXPECT_EQ(dut.noteDeath(100), 100 + pause_us);
  }
  EXPECT_FALSE(dut.noteDeath(100));
}

/// It needs up to 10 s to fail, for instance at a camera that does not answer.
TEST(RestartLimit, GivesUpAServiceThatFailsAtEveryStart) {
  RestartLimit dut;
  std::int64_t now = 0;
  int deaths = 0;
  for (; deaths < 100; ++deaths) {
    now += 10 * kSecond_us;
    const auto again = dut.noteDeath(now);
    if (!again) break;
    now = *again;
  }
  EXPECT_LT(deaths, 100);
}

TEST(RestartLimit, AlwaysRestartsAServiceThatDiesNowAndThen) {
  RestartLimit dut;
  for (std::int64_t now = 0; now < 24 * 3600 * kSecond_us; now += 61 * kSecond_us) {
    ASSERT_EQ(dut.noteDeath(now), now);
  }
}

}  // namespace
}  // namespace lab::runner::restart_limit_test
