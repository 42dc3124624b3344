// Cost of the projector's window of 1920 x 1080 in a virtual X server. "fill_ratio" is the CPU time
// of a frame divided by that of a frame filled with one grey, in the same run. "live" runs the
// frame loop at 60 Hz as projector_ctl does: intervals between swaps, and the share of one core of
// this process (the X server is another process).
#include <benchmark/benchmark.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <vector>

#include "common/loop/asio_loop.hpp"
#include "projector_ctl/display/display_sdl.hpp"
#include "projector_ctl/display/frame_loop.hpp"
#include "projector_ctl/display/screen_setup.hpp"
#include "tests/support/virtual_x.hpp"

namespace lab::projector {
namespace {

using lab::light::Blend;
using lab::light::Field;
using lab::light::Layer;
using lab::light::LayerKind;

constexpr int kColumns = 1920;
constexpr int kRows = 1080;

/// Twelve layers, of which `moving` change with time, and spots on robots that drive at 10 cm/s.
Field fieldAt(double time, bool moving, int spots) {
  const double t = moving ? time : 0;
  Field field;
  field.layers = {
      Layer{.intensity = 0.2},
      Layer{.kind = LayerKind::kHalfPlane,
            .x = 0.7,
            .y = 0.45,
            .angle = 0.3,
            .softness = 0.01,
            .intensity = 0.5},
      Layer{.kind = LayerKind::kRing,
            .x = 0.3,
            .y = 0.6,
            .size = 0.2,
            .inner = 0.15,
            .softness = 0.005,
            .intensity = 0.8},
      Layer{.kind = LayerKind::kDisk, .x = 0.9, .y = 0.7, .size = 0.12, .intensity = 0.9},
      Layer{.kind = LayerKind::kDisk, .x = 0.2, .y = 0.2, .size = 0.1, .intensity = 0.1},
      Layer{.kind = LayerKind::kRadialGradient,
            .blend = Blend::kMultiply,
            .x = 0.6,
            .y = 0.45,
            .size = 0.8,
            .inner = 0.55,
            .intensity = 1,
            .intensity2 = 0.5},
      Layer{.kind = LayerKind::kStripes,
            .blend = Blend::kMultiply,
            .x = 0.6,
            .y = 0.45,
            .size = 0.4,
            .inner = 0.5,
            .intensity = 1,
            .intensity2 = 0.9},
      Layer{.kind = LayerKind::kDisk,
            .x = 0.6 + 0.3 * std::cos(t),
            .y = 0.45 + 0.3 * std::sin(t),
            .size = 0.08,
            .softness = 0.01,
            .intensity = 1},
      Layer{.kind = LayerKind::kRing,
            .x = 0.6 - 0.3 * std::cos(t),
            .y = 0.45,
            .size = 0.1,
            .inner = 0.07,
            .intensity = 0},
      Layer{.kind = LayerKind::kDisk,
            .x = 0.6,
            .y = 0.45 + 0.3 * std::sin(t),
            .size = 0.06,
            .intensity = 0.6},
      Layer{.kind = LayerKind::kRing,
            .blend = Blend::kMax,
            .x = 0.4,
            .y = 0.45,
            .size = 0.12,
            .inner = 0.1,
            .softness = 0.01,
            .intensity = 0.7},
      Layer{.kind = LayerKind::kDisk,
            .blend = Blend::kMax,
            .x = 1.0,
            .y = 0.2,
            .size = 0.1,
            .softness = 0.05,
            .intensity = 0.5 + 0.5 * std::sin(5 * t)}};
  for (int i = 0; i < spots; ++i) {
    const double way = 0.1 * time + 0.7 * i;
    field.layers.push_back({.kind = LayerKind::kDisk,
                            .x = 0.6 + 0.5 * std::sin(0.9 * way + i),
                            .y = 0.45 + 0.35 * std::cos(way * 1.3),
                            .size = 0.05,
                            .softness = 0.005,
                            .intensity = 1});
  }
  return field;
}

lab::Experiment experiment() {
  lab::Experiment experiment;
  experiment.arena_width = 1.2;
  experiment.arena_height = 0.9;
  return experiment;
}

OpenDisplay opener() {
  return [] { return openSdlDisplay("0"); };
}

/// CPU time of this process [s].
double cpu() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// CPU time of a frame of one grey, the least of several [s].
double fillCost(Display& display) {
  lab::optics::GreyImage picture(kColumns, kRows);
  const Box whole{0, 0, kColumns, kRows};
  double least = 1;
  for (int i = 0; i < 30; ++i) {
    const double start = cpu();
    std::fill(picture.pixels.begin(), picture.pixels.end(), static_cast<std::uint8_t>(i));
    display.present(picture.view(), {&whole, 1});
    least = std::min(least, cpu() - start);
  }
  return least;
}

void frames(benchmark::State& state, bool moving, int spots) {
  const double fill = fillCost(*openSdlDisplay("0"));
  lab::AsioLoop loop;
  Screen::Setup setup = screenSetup(experiment(), {}, loop, opener());
  setup.sleep_until = nullptr;
  Screen screen(std::move(setup));
  screen.open();
  double time = 0;
  double least = 1;
  for (auto _ : state) {
    const double start = cpu();
    static_cast<void>(screen.run({fieldAt(time, moving, spots)}));
    if (time > 0) least = std::min(least, cpu() - start);
    time += 1.0 / 60;
  }
  state.counters["least_ms"] = 1e3 * least;
  state.counters["fill_ms"] = 1e3 * fill;
  state.counters["fill_ratio"] = least / fill;
}

void plainFill(benchmark::State& state) {
  const auto display = openSdlDisplay("0");
  for (auto _ : state) state.counters["least_ms"] = 1e3 * fillCost(*display);
}

void live(benchmark::State& state, int spots) {
  lab::AsioLoop loop;
  std::vector<std::int64_t> swaps;
  Field field;
  const FrameLoop frame_loop(
      loop, FrameClock(60),
      {[&](std::int64_t swap) -> const Field& {
         field = fieldAt(1e-6 * static_cast<double>(swap % 1'000'000'000), true, spots);
         return field;
       },
       [&](const FrameLoop::SwappedFrame& swapped) { swaps.push_back(swapped.utime); }},
      std::make_unique<ThreadPresenter>(screenSetup(experiment(), {}, loop, opener())));
  for (auto _ : state) {
    swaps.clear();
    const double start = cpu();
    const std::int64_t from = loop.now();
    loop.at(from + 8'000'000, [&loop] { loop.stop(); });
    loop.run();
    state.counters["cores"] = (cpu() - start) / (1e-6 * static_cast<double>(loop.now() - from));
  }
  std::vector<double> intervals;  // [ms]
  for (std::size_t i = 31; i < swaps.size(); ++i) {
    intervals.push_back(1e-3 * static_cast<double>(swaps[i] - swaps[i - 1]));
  }
  std::sort(intervals.begin(), intervals.end());
  if (intervals.empty()) return state.SkipWithError("no frames");
  const auto at = [&](double share) {
    return intervals[static_cast<std::size_t>(share * static_cast<double>(intervals.size() - 1))];
  };
  state.counters["p50_ms"] = at(0.5);
  state.counters["p99_ms"] = at(0.99);
  state.counters["max_ms"] = intervals.back();
  state.counters["hz"] = static_cast<double>(intervals.size()) /
                         (1e-6 * static_cast<double>(swaps.back() - swaps[30]));
}

BENCHMARK(plainFill)->Iterations(3)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frames, layers12_still, false, 0)->Iterations(120)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frames, layers12, true, 0)->Iterations(120)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frames, layers12_spots20, true, 20)
    ->Iterations(120)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(live, layers12, 0)->Iterations(1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(live, layers12_spots20, 20)->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lab::projector

int main(int argc, char** argv) {
  const lab::projector::VirtualX server(1920, 1080);
  if (!server.runs()) {
    std::fputs("projector_window_benchmark: Xvfb is not installed (package xvfb)\n", stderr);
    return 0;
  }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
