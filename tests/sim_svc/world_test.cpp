#include "sim_svc/world.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "tests/support/world_fixture.hpp"

namespace lab::sim {
namespace {

bool sameBits(const dynamics::Pose& a, const dynamics::Pose& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

TEST(World, RobotsStandUntilTheyAreCommanded) {
  World dut(WorldSettings(), robots(5));
  const dynamics::Pose before = dut.pose(3);
  dut.advanceTo(3 * kSecond);
  EXPECT_TRUE(sameBits(before, dut.pose(3)));
  EXPECT_TRUE(has(dut.state(3), dynamics::kLeaseExpired));
}

TEST(World, TheSameSeedGivesTheSameBits) {
  WorldSettings settings;
  settings.speed_noise = 0.002;
  settings.turn_noise = 0.05;
  settings.light_noise = 3;
  settings.wheel_gain_error = 0.02;
  const StepLight light(0.6, 0.2, 0.8);
  const auto run = [&](std::uint64_t seed) {
    settings.seed = seed;
    World world(settings, robots(30));
    world.setLight(&light);
    startAll(world, always(abpProgram()));
    world.advanceTo(60 * kSecond);
    std::vector<dynamics::Pose> poses;
    for (std::size_t i = 0; i < world.size(); ++i) poses.push_back(world.pose(i));
    return poses;
  };
  const auto first = run(5);
  const auto second = run(5);
  const auto other = run(6);
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_TRUE(sameBits(first[i], second[i])) << i;
    EXPECT_FALSE(sameBits(first[i], other[i])) << i;
  }
}

TEST(World, AddingARobotDoesNotChangeTheDrawsOfOthers) {
  WorldSettings settings;
  settings.arena = {20, 20};
  settings.wheel_gain_error = 0.02;
  World few(settings, robots(3));
  World more(settings, robots(4));
  startAll(few, always(abpProgram()));
  startAll(more, always(abpProgram()));
  few.advanceTo(30 * kSecond);
  more.advanceTo(30 * kSecond);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(few.clock(i).rate(), more.clock(i).rate());
    EXPECT_TRUE(sameBits(few.pose(i), more.pose(i))) << i;
  }
}

TEST(World, StepLengthsDoNotMatterWithoutContacts) {
  WorldSettings coarse = idealHardware();
  coarse.arena = {10, 10};
  coarse.clock_error = 0.01;
  WorldSettings fine = coarse;
  fine.tick_us = 1700;
  World a(coarse, robots(3));
  World b(fine, robots(3));
  startAll(a, always(abpProgram()));
  startAll(b, always(abpProgram()));
  a.advanceTo(20 * kSecond + 3333);
  b.advanceTo(20 * kSecond + 3333);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_NEAR(a.pose(i).x, b.pose(i).x, 1e-12);
    EXPECT_NEAR(a.pose(i).y, b.pose(i).y, 1e-12);
    EXPECT_NEAR(a.pose(i).theta, b.pose(i).theta, 1e-11);
    EXPECT_EQ(a.state(i).core.draw_count, b.state(i).core.draw_count);
  }
}

TEST(World, HoldsLastEpsilonOnTheRobotsOwnClock) {
  WorldSettings settings = idealHardware();
  settings.arena = {100, 100};
  settings.clock_error = 0.01;
  World dut(settings, robots(10));
  startAll(dut, always(abpProgram(0.03, 0.1, 3)));
  dut.advanceTo(10 * kSecond);
  for (std::size_t i = 0; i < dut.size(); ++i) {
    const RobotState state = dut.state(i);
    ASSERT_NE(dut.clock(i).rate(), 1.0);
    const double since = (10 - state.program_start) * dut.clock(i).rate();
    // Before the first draw, standing starts twice: without settings, and without light.
    EXPECT_EQ(state.core.draw_count - 2, std::floor(since / 0.1) + 1) << i;
  }
}

TEST(World, ClocksHaveTheGivenPhaseAndError) {
  WorldSettings settings;
  settings.arena = {100, 100};
  settings.clock_error = 0.005;
  const World dut(settings, robots(2000));
  double sum = 0;
  double sum2 = 0;
  double phase = 0;
  for (std::size_t i = 0; i < dut.size(); ++i) {
    const double error = dut.clock(i).rate() - 1;
    sum += error;
    sum2 += error * error;
    phase += std::fmod(dut.clock(i).phaseMs(), 500) / 500;
  }
  const double n = 2000;
  EXPECT_LT(std::abs(sum / n) / (0.005 / std::sqrt(n)), 4);
  EXPECT_LT(std::abs(sum2 / n / 2.5e-5 - 1) / std::sqrt(2 / n), 4);
  EXPECT_LT(std::abs(phase / n - 0.5) / std::sqrt(1 / 12.0 / n), 4);
}

TEST(World, RobotsBootAtRandomTimesInTheFirstSecond) {
  WorldSettings settings;
  settings.arena = {100, 100};
  World dut(settings, robots(2000));
  startAll(dut, always(abpProgram()));
  dut.advanceTo(2 * kSecond);
  double sum = 0;
  for (std::size_t i = 0; i < dut.size(); ++i) {
    const double start = dut.state(i).program_start;
    ASSERT_GE(start, 0);
    ASSERT_LE(start, 1.03);
    sum += start;
  }
  // Uniform within a second, plus up to a sensor period of 20 ms, plus half a millisecond of
  // rounding.
  EXPECT_LT(std::abs(sum / 2000 - 0.5105) / std::sqrt(1 / 12.0 / 2000), 4);
}

TEST(World, DrivesExactArcsThroughProgramChangesInsideATick) {
  World dut(idealHardware(), robotAt(0.6, 0.45, 0.3));
  startAll(dut, always(wheelsProgram(0.02, 0.05)));
  dut.advanceTo(777777);
  const RobotState state = dut.state(0);
  const double driven = 0.777777 - state.program_start;
  const dynamics::Pose expected =
      dynamics::apply(dynamics::makeArc(0.02, 0.05, 0.075, driven), {0.6, 0.45, 0.3});
  EXPECT_NEAR(state.pose.x, expected.x, 1e-13);
  EXPECT_NEAR(state.pose.y, expected.y, 1e-13);
  EXPECT_NEAR(state.pose.theta, expected.theta, 1e-13);
}

TEST(World, WheelsTurnInPwmStepsWithTheirTrueGains) {
  WorldSettings settings = idealHardware();
  settings.pwm_steps = true;
  World dut(settings, robotAt(0.2, 0.45, 0));
  startAll(dut, always(wheelsProgram(0.03, 0.03)));
  dut.advanceTo(5 * kSecond);
  const double driven = 5 - dut.state(0).program_start;
  EXPECT_NEAR(dut.pose(0).x - 0.2, 28 * 0.27 / 255 * driven, 1e-12);
  EXPECT_EQ(dut.state(0).wheel_left, 0.03) << "the commanded speed";

  settings.wheel_gain_error = 0.05;
  World wrong(settings, robotAt(0.2, 0.45, 0));
  startAll(wrong, always(wheelsProgram(0.03, 0.03)));
  wrong.advanceTo(5 * kSecond);
  EXPECT_GT(std::abs(wrong.pose(0).theta), 1e-3);
  EXPECT_LT(std::abs(wrong.pose(0).theta), 1);
}

TEST(World, LightSwitchesTheProgramWithinOneSensorPeriod) {
  WorldSettings settings = idealHardware();
  settings.clock_error = 0.01;
  World dut(settings, robots(50));
  const StepLight dark(0, 0, 0.1);
  const StepLight bright(0, 0, 0.9);
  dut.setLight(&dark);
  dynamics::CoreSettings table = always(abpProgram());
  table.light.count = 2;
  table.light.bands[0] = {0, 512, 0};
  table.light.bands[1] = {512, 1024, 1};
  table.programs[1] = always(rtpProgram(0.05, 1, 0.5)).programs[0];
  table.reversal.enabled = false;
  startAll(dut, table);
  dut.advanceTo(2 * kSecond);
  dut.setLight(&bright);
  dut.advanceTo(2 * kSecond + 30000);
  double latest = 0;
  for (std::size_t i = 0; i < dut.size(); ++i) {
    const RobotState state = dut.state(i);
    ASSERT_EQ(state.core.slot, 1) << i;
    ASSERT_GT(state.program_start, 2);
    ASSERT_LE(state.program_start, 2 + 0.020 / 0.97);
    latest = std::max(latest, state.program_start);
  }
  EXPECT_GT(latest, 2.015) << "the robots read their sensors at different times";
}

TEST(World, LightSensorsAreBeforeAndBehindTheAxle) {
  World dut(idealHardware(), robotAt(0.6, 0.45, 0));
  const StepLight light(0.6, 0.25, 0.75);
  dut.setLight(&light);
  dut.advanceTo(100000);
  EXPECT_EQ(dut.state(0).sensors.light_front, std::lround(0.75 * 1023));
  EXPECT_EQ(dut.state(0).sensors.light_back, std::lround(0.25 * 1023));
  const StepLight near_edge(0.625, 0.25, 0.75);
  dut.setLight(&near_edge);
  EXPECT_EQ(dut.measure(0).light_front, std::lround(0.75 * 1023));
  const StepLight far_edge(0.635, 0.25, 0.75);
  dut.setLight(&far_edge);
  EXPECT_EQ(dut.measure(0).light_front, std::lround(0.25 * 1023));
}

TEST(World, SensorsAreReadEveryTwentyMillisecondsOnly) {
  World dut(idealHardware(), robotAt(0.6, 0.45, 0));
  double previous = 0;
  int scans = 0;
  for (int step = 1; step <= 200; ++step) {
    dut.step(5000);
    const double sampled = dut.state(0).sampled_at;
    ASSERT_LE(sampled, dut.time());
    if (step < 10) {
      previous = sampled;
    } else if (sampled != previous) {
      ASSERT_NEAR(sampled - previous, 0.020, 1e-9);
      previous = sampled;
      ++scans;
    }
  }
  EXPECT_NEAR(scans, 47, 1);
}

TEST(World, AnExternalRobotIsOnlyDrivenBySetMotors) {
  std::vector<RobotSetup> setups = robotAt(0.3, 0.45, 0);
  setups[0].external = true;
  World dut(idealHardware(), setups);
  dut.advanceTo(kSecond);
  EXPECT_EQ(dut.pose(0).x, 0.3);
  dut.setMotors(0, {kSecond, 85, 85});  // a third of the full speed
  dut.advanceTo(3 * kSecond);
  EXPECT_NEAR(dut.pose(0).x, 0.3 + 2 * 0.09, 1e-12);
  dut.setMotors(0, {3 * kSecond, 0, 0});
  dut.advanceTo(4 * kSecond);
  EXPECT_NEAR(dut.pose(0).x, 0.3 + 2 * 0.09, 1e-12);
}

TEST(World, TheBatteryVoltageDecreasesSlowly) {
  World dut(WorldSettings(), robots(1));
  const double full = dut.state(0).battery;
  dut.advanceTo(60 * kSecond);
  EXPECT_LT(dut.state(0).battery, full);
  EXPECT_GT(dut.state(0).battery, full - 0.01);
}

TEST(World, ProcessNoiseOnlyAffectsMovingRobots) {
  WorldSettings settings = idealHardware();
  settings.arena = {50, 50};
  settings.speed_noise = 0.01;
  settings.turn_noise = 0.1;
  World standing(settings, robots(1));
  const dynamics::Pose before = standing.pose(0);
  standing.advanceTo(kSecond);
  EXPECT_TRUE(sameBits(before, standing.pose(0)));

  World moving(settings, robots(500));
  startAll(moving, always(wheelsProgram(0.001, 0.001)));
  moving.advanceTo(kSecond);
  std::vector<double> theta;
  for (std::size_t i = 0; i < moving.size(); ++i) theta.push_back(moving.pose(i).theta);
  moving.advanceTo(5 * kSecond);
  double turned2 = 0;
  for (std::size_t i = 0; i < moving.size(); ++i) {
    turned2 += std::pow(moving.pose(i).theta - theta[i], 2) / 500;
  }
  EXPECT_LT(std::abs(turned2 / (0.01 * 4) - 1) / std::sqrt(2 / 500.0), 4);
}

}  // namespace
}  // namespace lab::sim
