// Speed of the simulated world, with walls, infrared sensors, light, contacts that slide, clock
// errors and PWM. Counters: simulated robot-seconds per second, speed relative to real time, and
// time per robot and tick.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstddef>
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

struct Crowd {
  int robots = 1;
  double scale = 1;      ///< Of both sides of the real arena.
  bool reverses = true;  ///< From walls and robots; false: they push and slide.
  std::size_t threads = 1;
  std::int64_t warm_up_s = 30;
};

void runWorld(benchmark::State& state, const Crowd& crowd) {
  const int robots = crowd.robots;
  lab::sim::WorldSettings settings;
  settings.arena.width *= crowd.scale;
  settings.arena.height *= crowd.scale;
  std::vector<lab::sim::RobotSetup> setups;
  for (int id = 1; id <= robots; ++id) setups.push_back({id, std::nullopt, false});
  World world(settings, setups);
  world.setThreads(crowd.threads);
  const TwoHalves light(settings.arena.width / 2);
  world.setLight(&light);
  const std::vector<lab::Program> programs = abpAndRtp();
  for (const lab::Program& program : programs) world.addProgram(program.hash, program.code);
  CoreSettings core_settings = settingsOf(programs);
  core_settings.reversal.enabled = crowd.reverses;
  for (std::size_t i = 0; i < world.size(); ++i) {
    world.order(i, [&core_settings](auto& core, auto now_ms) {
      core.configure(now_ms, core_settings);
      core.renewLease(now_ms, lab::dynamics::RobotCore::kNoEventMs);
    });
  }
  constexpr std::int64_t kSecond = 1000000;
  world.advanceTo(crowd.warm_up_s * kSecond);
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

/// A scale that keeps the density of 20 robots in the real arena.
double atTheDensityOfTwenty(int robots) { return std::sqrt(robots / 20.0); }

void oneRobot(benchmark::State& state) { runWorld(state, {.robots = 1}); }
void twentyRobots(benchmark::State& state) { runWorld(state, {.robots = 20}); }
void twentyRobotsThatPush(benchmark::State& state) {
  runWorld(state, {.robots = 20, .reverses = false});
}
void realArena100ThatPush(benchmark::State& state) {
  runWorld(state, {.robots = 100, .reverses = false});
}
void realArena150(benchmark::State& state) { runWorld(state, {.robots = 150}); }
void thousand(benchmark::State& state) {
  runWorld(state, {.robots = 1000, .scale = atTheDensityOfTwenty(1000)});
}
void thousandThatPush(benchmark::State& state) {
  runWorld(state, {.robots = 1000, .scale = atTheDensityOfTwenty(1000), .reverses = false});
}
void tenThousand(benchmark::State& state) {
  runWorld(state, {.robots = 10'000, .scale = atTheDensityOfTwenty(10'000), .warm_up_s = 3});
}
void tenThousandThatPush(benchmark::State& state) {
  runWorld(state, {.robots = 10'000,
                   .scale = atTheDensityOfTwenty(10'000),
                   .reverses = false,
                   .warm_up_s = 10});
}
void tenThousandOnAllProcessors(benchmark::State& state) {
  runWorld(state, {.robots = 10'000,
                   .scale = atTheDensityOfTwenty(10'000),
                   .threads = lab::sim::availableProcessors(),
                   .warm_up_s = 3});
}
void hundredThousand(benchmark::State& state) {
  runWorld(state, {.robots = 100'000, .scale = atTheDensityOfTwenty(100'000), .warm_up_s = 1});
}

BENCHMARK(oneRobot);
BENCHMARK(twentyRobots);
BENCHMARK(twentyRobotsThatPush);
BENCHMARK(realArena100ThatPush);
BENCHMARK(realArena150);
BENCHMARK(thousand);
BENCHMARK(thousandThatPush);
BENCHMARK(tenThousand);
BENCHMARK(tenThousandThatPush);
BENCHMARK(tenThousandOnAllProcessors)->UseRealTime();
BENCHMARK(hundredThousand)->Iterations(2);

}  // namespace

BENCHMARK_MAIN();
