// Compares the simulated robots with the exact laws of their programs.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "sim_svc/world.hpp"
#include "tests/support/world_fixture.hpp"

namespace lab::sim {
namespace {

constexpr int kRobots = 4000;

struct Mean {
  double value = 0;
  double error = 0;  ///< Standard error.
};

/// Mean of `observe` between two times over many robots, in an arena too large to meet a wall.
Mean overRobots(
    const Program& program, double from_s, double to_s,
    const std::function<double(const dynamics::Pose&, const dynamics::Pose&)>& observe) {
  WorldSettings settings;
  settings.pwm_steps = false;
  settings.arena = {400, 400};
  World world(settings, robots(kRobots));
  startAll(world, always(program));
  const auto us = [](double s) { return static_cast<std::int64_t>(std::llround(s * 1e6)); };
  world.advanceTo(us(from_s));
  std::vector<dynamics::Pose> before;
  for (std::size_t i = 0; i < world.size(); ++i) before.push_back(world.pose(i));
  world.advanceTo(us(to_s));
  double sum = 0;
  double sum2 = 0;
  for (std::size_t i = 0; i < world.size(); ++i) {
    const double x = observe(before[i], world.pose(i));
    sum += x;
    sum2 += x * x;
  }
  const double mean = sum / kRobots;
  return {mean, std::sqrt((sum2 / kRobots - mean * mean) / kRobots)};
}

double squaredDistance(const dynamics::Pose& a, const dynamics::Pose& b) {
  return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
}

double squaredTurn(const dynamics::Pose& a, const dynamics::Pose& b) {
  return (a.theta - b.theta) * (a.theta - b.theta);
}

TEST(WorldPhysics, AbpTurnsByTheExactAngularMsd) {
  // 2 Dr (tau - eps / 3) beyond eps, <w^2> (tau^2 - tau^3 / (3 eps)) below, Dr = eps eta^2 / 6.
  for (const double tau : {0.2, 1.0, 8.0}) {
    const Mean found = overRobots(abpProgram(0.03, 0.5, 3), 5, 5 + tau, squaredTurn);
    const double exact =
        tau < 0.5 ? 3 * (tau * tau - tau * tau * tau / 1.5) : 1.5 * (tau - 0.5 / 3);
    EXPECT_LT(std::abs(found.value - exact) / found.error, 4) << tau;
  }
}

TEST(WorldPhysics, WheelNoiseTurnsByItsExactAngularMsd) {
  // Dr = eps V^2 / (3 d^2).
  const Mean found = overRobots(bpProgram(0.01, 0.10, 0.1), 5, 15, squaredTurn);
  const double dr = 0.1 * 0.01 / (3 * 0.075 * 0.075);
  EXPECT_LT(std::abs(found.value - 2 * dr * (10 - 0.1 / 3)) / found.error, 4);
}

TEST(WorldPhysics, RunAndTumbleSpreadsByEquationSix) {
  // MSD = 2 v^2 (gamma tau - 1 + exp(-gamma tau)) / (gamma^2 (1 + gamma tau_t)), exact at all lags
  // in the stationary state.
  const double v = 0.05;
  for (const double gamma : {1.0, 3.0}) {
    for (const double tau : {0.3, 2.0, 10.0}) {
      const Mean found = overRobots(rtpProgram(v, gamma, 0.5), 10, 10 + tau, squaredDistance);
      const double x = gamma * tau;
      const double exact = 2 * v * v * (x - 1 + std::exp(-x)) / (gamma * gamma * (1 + gamma * 0.5));
      EXPECT_LT(std::abs(found.value - exact) / found.error, 4) << gamma << " " << tau;
    }
  }
}

TEST(WorldPhysics, NumberOfReversalsInAnHourIsAsExpected) {
  // v = 3 cm/s, eps = 0.5 s, eta = 3 rad/s: 52 reversals per hour and 94.6 % of the time without
  // reversal, from an independent simulation with the same infrared range and reverse speed.
  constexpr int kHours = 12;
  double reversals = 0;
  double reversing = 0;
  double touched = 0;
  for (int hour = 0; hour < kHours; ++hour) {
    WorldSettings settings;
    settings.seed = static_cast<std::uint64_t>(hour + 1);
    World world(settings, robots(1));
    startAll(world, always(abpProgram()));
    std::uint32_t ended = 0;
    while (world.timeUs() < 3600 * kSecond) {
      world.advanceTo(world.timeUs() + 100000);
      reversing += has(world.state(0), dynamics::kReversing) ? 0.1 / 3600 : 0;
      ended = world.state(0).core.reversal_count;
    }
    reversals += ended;
    touched += static_cast<double>(world.state(0).wall_contacts);
  }
  EXPECT_NEAR(reversals / kHours, 52, 8);
  EXPECT_GT(1 - reversing / kHours, 0.93);
  EXPECT_LT(touched / kHours, 1);
}

}  // namespace
}  // namespace lab::sim
