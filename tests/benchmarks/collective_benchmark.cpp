// The collective analysis: what a second of 100 frames costs, and the results of all groups once.
#include <benchmark/benchmark.h>

#include <cstdint>
#include <vector>

#include "tests/analyzer/collective/simulated_crowd.hpp"

namespace lab::collective {
namespace {

constexpr double kFrame = 0.01;  // [s]

CrowdConfig config() {
  CrowdConfig config;
  config.settings.arena = {0, 0, 1.2, 0.9};
  config.regions = {{"left", false, 0.3, 0.45, 0, 0.6, 0.9}};
  config.bands = {"one", "two"};
  return config;
}

/// Frames of robots without collisions, half of them with another program.
std::vector<std::vector<CrowdPose>> recording(int robots, int frames) {
  SimulatedCrowd crowd({.robots = robots});
  std::vector<std::vector<CrowdPose>> all;
  for (int k = 0; k < frames; ++k) {
    crowd.step(kFrame);
    all.push_back(crowd.poses());
    for (CrowdPose& pose : all.back()) pose.program = pose.band = pose.robot % 2;
  }
  return all;
}

/// A second of the lab: 100 frames and the results of three groups.
void secondOfCrowd(benchmark::State& state) {
  constexpr int kFrames = 1000;
  const auto frames = recording(static_cast<int>(state.range(0)), kFrames);
  CrowdAnalysis dut(config());
  std::int64_t frame = 0;
  for (auto _ : state) {
    for (int k = 0; k < 100; ++k, ++frame) {
      dut.addFrame(kFrame * static_cast<double>(frame), kFrame,
                   frames[static_cast<std::size_t>(frame % kFrames)]);
    }
    benchmark::DoNotOptimize(dut.results());
  }
  state.counters["of_a_core"] =
      benchmark::Counter(static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(secondOfCrowd)->Arg(20)->Arg(100)->Arg(250)->Arg(1000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lab::collective

BENCHMARK_MAIN();
