// Cost of the light field: the simulator evaluates it at every sensor, the projector at every
// pixel.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "light/field/field.hpp"
#include "light/field/raster.hpp"

namespace {

using lab::light::CompiledField;
using lab::light::Field;
using lab::light::Layer;
using lab::light::LayerKind;

constexpr double kWidth = 1.2;
constexpr double kHeight = 0.9;
constexpr double kSensorRadius = 0.002;

/// Uniform light for 0 layers; otherwise layers of all geometric kinds, the first a half plane.
Field fieldOf(std::int64_t layers) {
  Field field;
  if (layers == 0) field.layers.push_back({.intensity = 0.5});
  for (std::int64_t i = 0; i < layers; ++i) {
    Layer layer{.x = 0.1 + 0.08 * static_cast<double>(i), .y = 0.45, .angle = 0.3};
    layer.kind = static_cast<LayerKind>(2 + i % 7);
    layer.size = 0.2;
    layer.inner = 0.1;
    layer.softness = 0.01;
    layer.intensity = 0.9;
    layer.intensity2 = 0.2;
    layer.blend = i == 0 ? lab::light::Blend::kOver : lab::light::Blend::kMax;
    field.layers.push_back(layer);
  }
  return field;
}

void evaluateAtSensors(benchmark::State& state) {
  const CompiledField field(fieldOf(state.range(0)));
  double x = 0;
  for (auto _ : state) {
    x = x < kWidth ? x + 0.0137 : 0;
    benchmark::DoNotOptimize(field.evaluate(x, 0.4));
  }
}
BENCHMARK(evaluateAtSensors)->Arg(0)->Arg(1)->Arg(12);

void evaluateOverSensorDisk(benchmark::State& state) {
  const CompiledField field(fieldOf(state.range(0)));
  double x = 0;
  for (auto _ : state) {
    x = x < kWidth ? x + 0.0137 : 0;
    benchmark::DoNotOptimize(field.evaluateOverDisk(x, 0.4, kSensorRadius));
  }
}
BENCHMARK(evaluateOverSensorDisk)->Arg(0)->Arg(1)->Arg(12);

void rasteriseFullHd(benchmark::State& state) {
  const CompiledField field(fieldOf(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(rasterise(field, kWidth, kHeight, 1920, 1080));
}
BENCHMARK(rasteriseFullHd)->Arg(0)->Arg(1)->Arg(12)->Unit(benchmark::kMillisecond);

/// One layer of the given LayerKind: stripes, noise with patches of 5 cm, waves.
void rasteriseKindFullHd(benchmark::State& state) {
  Field field = fieldOf(1);
  Layer& layer = field.layers.front();
  layer.kind = static_cast<LayerKind>(state.range(0));
  layer.size = 0.05;
  layer.inner = 0.5;
  const CompiledField compiled(field);
  for (auto _ : state) benchmark::DoNotOptimize(rasterise(compiled, kWidth, kHeight, 1920, 1080));
}
BENCHMARK(rasteriseKindFullHd)->Arg(7)->Arg(11)->Arg(12)->Unit(benchmark::kMillisecond);

void rampFrameFullHd(benchmark::State& state) {
  lab::light::FramePainter painter(kWidth, kHeight, 1920, 1080);
  Field field = fieldOf(12);
  field.previous = fieldOf(1).layers;
  field.mix = 0;
  painter.paint(field);
  for (auto _ : state) {
    field.mix = field.mix < 0.98 ? field.mix + 0.01 : 0;
    benchmark::DoNotOptimize(painter.paint(field).values.data());
  }
}
BENCHMARK(rampFrameFullHd)->Unit(benchmark::kMillisecond);

/// Baseline: fills a full-HD raster.
void plainFillFullHd(benchmark::State& state) {
  for (auto _ : state) {
    std::vector<float> values(1920UL * 1080UL);
    std::fill(values.begin(), values.end(), 0.5F);
    benchmark::DoNotOptimize(values.data());
  }
}
BENCHMARK(plainFillFullHd)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
