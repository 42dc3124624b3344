// A crowd over a day.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include "tests/support/world_fixture.hpp"

namespace lab::sim::world_day_test {
namespace {

constexpr double kRadius = 0.0375;

TEST(WorldDay, AHundredRobotsNeverOverlapOrLeaveTheArena) {
  World dut(WorldSettings(), robots(100));
  dynamics::CoreSettings core = always(abpProgram(0.05, 0.5, 3));
  core.reversal.enabled = false;
  startAll(dut, core);
  double overlap = 0;
  double outside = 0;
  for (std::int64_t second = 1; second <= 86400; ++second) {
    dut.advanceTo(second * kSecond);
    for (std::size_t i = 0; i < dut.size(); ++i) {
      const dynamics::Pose a = dut.pose(i);
      ASSERT_TRUE(std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.theta));
      outside = std::max(
          {outside, kRadius - a.x, kRadius - a.y, a.x - (1.2 - kRadius), a.y - (0.9 - kRadius)});
      for (std::size_t j = 0; j < i; ++j) {
        const dynamics::Pose b = dut.pose(j);
        overlap = std::max(overlap, 2 * kRadius - std::hypot(a.x - b.x, a.y - b.y));
      }
    }
    ASSERT_LT(overlap, 1e-6) << "after " << second << " s";
    ASSERT_LT(outside, 1e-6) << "after " << second << " s";
  }
  EXPECT_GT(dut.collisions(), 1'000'000);
  EXPECT_EQ(dut.sliding().unsolvedIslands(), 0);
  RecordProperty("largest overlap [nm]", std::to_string(overlap * 1e9));
  RecordProperty("islands", std::to_string(dut.sliding().islands()));
}

}  // namespace
}  // namespace lab::sim::world_day_test
