// Speed of the simulated camera. Arguments: rows of the picture, robots. "still": constant light,
// moving robots; "ramp": a cross-fade with another mix in every frame; "spots": new layers in every
// frame, a spot on each robot. Counter: frames per second on one core.
#include <benchmark/benchmark.h>

#include <cstdint>
#include <vector>

#include "light/optics/simulated_camera.hpp"
#include "sim_svc/camera_painter.hpp"

namespace {

using lab::sim::CameraPainter;
using lab::sim::PaintedRobot;

std::vector<PaintedRobot> robots(std::int64_t count, std::int64_t frame) {
  std::vector<PaintedRobot> all;
  for (std::int64_t i = 0; i < count; ++i) {
    PaintedRobot robot;
    robot.x = 0.06 + 0.118 * static_cast<double>(i % 10) + 1e-4 * static_cast<double>(frame % 100);
    robot.y = 0.08 + 0.17 * static_cast<double>(i / 10);
    robot.theta = 0.7 * static_cast<double>(i + frame);
    robot.vx = 0.03;
    robot.omega = 0.5;
    all.push_back(robot);
  }
  return all;
}

lab::light::Layer uniform(double intensity) {
  lab::light::Layer layer;
  layer.intensity = intensity;
  return layer;
}

/// Light on one half of the arena.
lab::light::Field half() {
  lab::light::Layer edge = uniform(1);
  edge.kind = lab::light::LayerKind::kHalfPlane;
  edge.x = 0.6;
  edge.y = 0.45;
  edge.angle = 0.4;
  return {{uniform(0.12), edge}, {}, 1};
}

lab::light::Field spots(const std::vector<PaintedRobot>& on) {
  lab::light::Field field{{uniform(0.1)}, {}, 1};
  for (const PaintedRobot& robot : on) {
    lab::light::Layer spot = uniform(1);
    spot.kind = lab::light::LayerKind::kDisk;
    spot.x = robot.x;
    spot.y = robot.y;
    spot.size = 0.05;
    spot.softness = 0.005;
    field.layers.push_back(spot);
  }
  return field;
}

template <class Light>
void paint(benchmark::State& state, Light light) {
  const int rows = static_cast<int>(state.range(0));
  const int columns = rows * 16 / 9;
  lab::sim::PainterSettings settings;
  settings.camera = lab::optics::simulatedCamera(columns, rows, 1.20, 0.90);
  CameraPainter painter(settings);
  painter.setLight(half());
  std::vector<std::uint8_t> picture(static_cast<std::size_t>(columns) *
                                    static_cast<std::size_t>(rows));
  std::int64_t frame = 0;
  for (auto _ : state) {
    const std::vector<PaintedRobot> there = robots(state.range(1), frame);
    light(painter, there, frame);
    painter.paint(there, frame++, picture);
    benchmark::DoNotOptimize(picture.data());
  }
  state.counters["frames_per_s"] =
      benchmark::Counter(static_cast<double>(frame), benchmark::Counter::kIsRate);
}

void stillLight(benchmark::State& state) {
  paint(state, [](CameraPainter&, const auto&, std::int64_t) {});
}

void ramp(benchmark::State& state) {
  paint(state, [](CameraPainter& painter, const auto&, std::int64_t frame) {
    lab::light::Field field = half();
    field.previous = {uniform(0.5)};
    field.mix = 0.01 * static_cast<double>(frame % 100);
    painter.setLight(field);
  });
}

void spotsOnRobots(benchmark::State& state) {
  paint(state, [](CameraPainter& painter, const auto& there, std::int64_t) {
    painter.setLight(spots(there));
  });
}

BENCHMARK(stillLight)
    ->Unit(benchmark::kMillisecond)
    ->ArgsProduct({{720, 1080}, {1, 20, 50}})
    ->ArgNames({"rows", "robots"});
BENCHMARK(ramp)->Unit(benchmark::kMillisecond)->Args({720, 20})->ArgNames({"rows", "robots"});
BENCHMARK(spotsOnRobots)
    ->Unit(benchmark::kMillisecond)
    ->ArgsProduct({{720, 1080}, {20}})
    ->ArgNames({"rows", "robots"});

}  // namespace

BENCHMARK_MAIN();
