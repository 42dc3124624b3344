#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sim_svc/world.hpp"
#include "tests/support/world_fixture.hpp"

namespace lab::sim::world_crowd_test {
namespace {

constexpr double kRadius = 0.0375;

/// What robots may overlap [m]: rounding, or what the solver of sliding contacts leaves.
double mostOverlap(const World& world) {
  return world.settings().contact == ContactRule::kStop ? 1e-12 : 1e-6;
}

void expectHardDisksInside(const World& world) {
  const Arena arena = world.settings().arena;
  const double overlap = mostOverlap(world);
  const double nearest = 2 * kRadius - overlap;
  for (std::size_t i = 0; i < world.size(); ++i) {
    const dynamics::Pose a = world.pose(i);
    ASSERT_GE(a.x, kRadius - overlap) << i;
    ASSERT_LE(a.x, arena.width - kRadius + overlap) << i;
    ASSERT_GE(a.y, kRadius - overlap) << i;
    ASSERT_LE(a.y, arena.height - kRadius + overlap) << i;
    for (std::size_t j = 0; j < i; ++j) {
      const dynamics::Pose b = world.pose(j);
      ASSERT_GE((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y), nearest * nearest)
          << i << " " << j;
    }
  }
}

/// With both rules of contact.
class WorldCrowd : public ::testing::TestWithParam<ContactRule> {
 protected:
  // Two minutes of 150 robots in an arena of real size, checked after every tick.
  static void runCrowd(WorldSettings settings, const dynamics::CoreSettings& core,
                       bool robots_seen) {
    settings.contact = GetParam();
    World dut(settings, robots(150));
    for (std::size_t i = 0; i < dut.size(); ++i) dut.setReversesFromRobots(i, robots_seen);
    startAll(dut, core);
    while (dut.timeUs() < 120 * kSecond) {
      dut.step(10000);
      expectHardDisksInside(dut);
      if (::testing::Test::HasFatalFailure()) FAIL() << "at " << dut.time() << " s";
    }
    EXPECT_GT(dut.collisions(), 1000);
    EXPECT_EQ(dut.sliding().unsolvedIslands(), 0);
  }
};

INSTANTIATE_TEST_SUITE_P(Rules, WorldCrowd,
                         ::testing::Values(ContactRule::kSlide, ContactRule::kStop),
                         [](const auto& rule) {
                           return rule.param == ContactRule::kSlide ? "slide" : "stop";
                         });

TEST_P(WorldCrowd, NeverOverlapsWithoutReversalsFromRobots) {
  runCrowd(WorldSettings(), always(abpProgram(0.05, 0.25, 5)), false);
}

TEST_P(WorldCrowd, NeverOverlapsWithReversalsFromRobots) {
  runCrowd(WorldSettings(), always(bpProgram(0, 0.25, 0.1)), true);
}

TEST_P(WorldCrowd, NeverOverlapsWithoutReversalsAtFullSpeedWithNoise) {
  WorldSettings settings;
  settings.speed_noise = 0.02;
  settings.turn_noise = 0.3;
  settings.wheel_gain_error = 0.05;
  dynamics::CoreSettings core = always(rtpProgram(0.27, 1, 0.5));
  core.reversal.enabled = false;
  runCrowd(settings, core, true);
}

TEST_P(WorldCrowd, RobotsInContactSeparateAgain) {
  // A permanently jammed crowd would stop moving; this one must keep mixing.
  WorldSettings settings;
  settings.contact = GetParam();
  World dut(settings, robots(60));
  for (std::size_t i = 0; i < dut.size(); ++i) dut.setReversesFromRobots(i, false);
  startAll(dut, always(abpProgram()));
  dut.advanceTo(60 * kSecond);
  std::vector<dynamics::Pose> before;
  for (std::size_t i = 0; i < dut.size(); ++i) before.push_back(dut.pose(i));
  dut.advanceTo(180 * kSecond);
  int moved = 0;
  for (std::size_t i = 0; i < dut.size(); ++i) {
    const dynamics::Pose now = dut.pose(i);
    moved += std::hypot(now.x - before[i].x, now.y - before[i].y) > 0.03 ? 1 : 0;
  }
  EXPECT_GT(moved, 55);
}

}  // namespace
}  // namespace lab::sim::world_crowd_test
