// Cost of a projector frame with layers that follow robots, compared with constant and moving
// layers. Without bus, messages and display.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>

#include "projector_ctl/projector_core.hpp"

namespace {

using lab::light::Drive;
using lab::light::DrivenLayer;
using lab::light::Follow;
using lab::light::Layer;
using lab::light::LayerKind;

constexpr std::int64_t kStart = 1'000'000'000'000;  // [us]
constexpr std::int64_t kFrame_us = 16'667;
constexpr int kRobots = 20;

lab::projector::ObservedFrame frameAt(std::int64_t utime, std::int64_t number) {
  lab::projector::ObservedFrame frame{1, number, utime, {}};
  const double t = 1e-6 * static_cast<double>(utime - kStart);
  for (int id = 1; id <= kRobots; ++id) {
    const double angle = t + id;
    frame.robots.push_back({id, 0.6 + 0.02 * id * std::cos(angle),
                            0.45 + 0.02 * id * std::sin(angle), angle, 1e-7, 1e-4, 1});
  }
  return frame;
}

/// Frames of 12 layers, `followers` of which follow 20 robots and `trails` are trails.
void frames(benchmark::State& state, int movers, int followers, int trails) {
  lab::projector::ProjectorCore::Config config;
  for (int id = 1; id <= kRobots; ++id) config.scene_context.robots.push_back(id);
  lab::projector::ProjectorCore core(config);
  lab::projector::LightCommand command{.sender = "lab", .seq = 1, .from_utime = kStart};
  command.hold_until_utime = kStart + 1'000'000'000'000;
  for (int i = 0; i < 12; ++i) {
    DrivenLayer layer{
        {.kind = LayerKind::kDisk, .x = 0.1, .y = 0.1, .size = 0.04, .intensity = 0.9}, {}};
    if (i < followers) {
      layer.drive.follow = Follow::kRobots;
    } else if (i < followers + trails) {
      layer.drive.follow = Follow::kTrail;
      layer.drive.diffusion = 1e-4;
    } else if (i < followers + trails + movers) {
      layer.drive.vx = 0.01;
    }
    command.layers.push_back(layer);
  }
  if (core.apply(command, kStart).verdict != lab::projector::Verdict::kAccepted) {
    state.SkipWithError("refused");
    return;
  }
  std::int64_t number = 0;
  std::int64_t now = kStart;
  for (auto _ : state) {
    now += kFrame_us;
    core.addFrame(frameAt(now - 20'000, ++number));
    benchmark::DoNotOptimize(core.frame(now).field.layers.data());
  }
}
BENCHMARK_CAPTURE(frames, twelve_still, 0, 0, 0);
BENCHMARK_CAPTURE(frames, twelve_moving, 12, 0, 0);
BENCHMARK_CAPTURE(frames, five_moving_and_seven_on_20_robots, 5, 7, 0);
BENCHMARK_CAPTURE(frames, eleven_moving_and_a_trail_of_20_robots, 11, 0, 1);

}  // namespace

BENCHMARK_MAIN();
