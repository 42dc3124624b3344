// Speed of the simulated world, with walls, infrared sensors, light, collisions, clock errors and
// PWM. Counters: simulated robot-seconds per second, speed relative to real time, and time per
// robot and tick.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "robot/dynamics/robot_program.hpp"
#include "sim_svc/world.hpp"

namespace {

using lab::dynamics::CoreSettings;
using lab::sim::World;

/// Two halves with different light, so that robots change programs when they cross.
class TwoHalves : public lab::sim::LightSampler {
 public:
  explicit TwoHalves(double edge) : edge_(edge) {}
  [[nodiscard]] double at(double x, double) const override { return x < edge_ ? 0.25 : 0.75; }

 private:
  double edge_;
};

CoreSettings abpAndRtp() {
  lab::dynamics::RobotProgram abp;
  abp.kind = lab::dynamics::kAbp;
  abp.v = 0.03;
  abp.epsilon = 0.5;
  abp.eta = 3;
  lab::dynamics::RobotProgram rtp;
  rtp.kind = lab::dynamics::kRtp;
  rtp.v = 0.05;
  rtp.gamma = 1;
  rtp.tau_t = 0.5;
  CoreSettings settings;
  settings.light.count = 2;
  settings.light.bands[0] = {0, 512, 0};
  settings.light.bands[1] = {512, 1024, 1};
  settings.light.hysteresis = 20;
  settings.programs[0] = lab::dynamics::toProgramParams(abp).params;
  settings.programs[1] = lab::dynamics::toProgramParams(rtp).params;
  return settings;
}

/// Runs `robots` robots in the real arena, scaled by `scale` along both sides.
void runWorld(benchmark::State& state, int robots, double scale) {
  lab::sim::WorldSettings settings;
  settings.arena.width *= scale;
  settings.arena.height *= scale;
  std::vector<lab::sim::RobotSetup> setups;
  for (int id = 1; id <= robots; ++id) setups.push_back({id, std::nullopt, false});
  World world(settings, setups);
  const TwoHalves light(settings.arena.width / 2);
  world.setLight(&light);
  for (std::size_t i = 0; i < world.size(); ++i) {
    world.order(i, [](auto& core, auto now_ms) {
      core.configure(now_ms, abpAndRtp());
      core.renewLease(now_ms, lab::dynamics::RobotCore::kNoEventMs);
    });
  }
  constexpr std::int64_t kSecond = 1000000;
  world.advanceTo(30 * kSecond);
  std::int64_t seconds = 0;
  for (auto _ : state) {
    world.advanceTo(world.timeUs() + kSecond);
    ++seconds;
  }
  using benchmark::Counter;
  const double robot_seconds = static_cast<double>(seconds * robots);
  state.counters["robot_s_per_s"] = Counter(robot_seconds, Counter::kIsRate);
  state.counters["x_real_time"] = Counter(static_cast<double>(seconds), Counter::kIsRate);
  state.counters["s_per_robot_tick"] =
      Counter(robot_seconds * 100, Counter::kIsRate | Counter::kInvert);
}

void oneRobot(benchmark::State& state) { runWorld(state, 1, 1); }
void twentyRobots(benchmark::State& state) { runWorld(state, 20, 1); }
void realArena150(benchmark::State& state) { runWorld(state, 150, 1); }
void thousandAtTheDensityOfTwenty(benchmark::State& state) {
  runWorld(state, 1000, std::sqrt(50.0));
}

BENCHMARK(oneRobot);
BENCHMARK(twentyRobots);
BENCHMARK(realArena150);
BENCHMARK(thousandAtTheDensityOfTwenty);

}  // namespace

BENCHMARK_MAIN();
