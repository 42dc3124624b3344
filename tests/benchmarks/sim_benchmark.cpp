// Speed of the simulated world, with walls, infrared sensors, light, collisions, clock errors and
// PWM. Counters: simulated robot-seconds per second, speed relative to real time, and time per
// robot and tick.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/programs/shipped_programs.hpp"
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

/// The programs of dark and bright light.
std::vector<lab::Program> abpAndRtp() {
  return {lab::shippedProgram("abp", {{"v", "3 cm/s"}, {"epsilon", "0.5 s"}, {"eta", "3 rad/s"}}),
          lab::shippedProgram("rtp", {{"v", "5 cm/s"}, {"gamma", "1 1/s"}, {"tau_t", "0.5 s"}})};
}

CoreSettings settingsOf(const std::vector<lab::Program>& programs) {
  CoreSettings settings;
  settings.light.count = 2;
  settings.light.bands[0] = {0, 512, 0};
  settings.light.bands[1] = {512, 1024, 1};
  settings.light.hysteresis = 20;
  for (std::size_t slot = 0; slot < programs.size(); ++slot) {
    settings.programs[slot] = programs[slot].hash;
  }
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
  const std::vector<lab::Program> programs = abpAndRtp();
  for (const lab::Program& program : programs) world.addProgram(program.hash, program.code);
  const CoreSettings core_settings = settingsOf(programs);
  for (std::size_t i = 0; i < world.size(); ++i) {
    world.order(i, [&core_settings](auto& core, auto now_ms) {
      core.configure(now_ms, core_settings);
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
