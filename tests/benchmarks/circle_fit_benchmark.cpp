// The sub-pixel fit of the 100 circles of 50 robots, in uniform light and with a light edge across
// each, compared with reading the pixels of the same circles once.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "tests/support/circle_picture.hpp"
#include "tracker_svc/circle_fit.hpp"

namespace {

using namespace lab;
using detector::testing::CirclePicture;

constexpr int kCircles = 100;

struct Shot {
  optics::GreyImage image;
  optics::Pixel start;
  detector::DiscShape shape;
};

// Big and small circles alternately, each with the start error of the detector's search.
std::vector<Shot> shots(double scale, double shade) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> even(-1, 1);
  std::vector<Shot> out;
  for (int i = 0; i < kCircles; ++i) {
    CirclePicture picture;
    picture.x = 24 + 0.5 * even(random);
    picture.y = 24 + 0.5 * even(random);
    const double radius = scale * (i % 2 == 0 ? 6.7 : 4.1);
    picture.shape = detector::testing::roundShape(radius, 1.02, 3 * even(random));
    const double angle = 3.2 * even(random);
    const double offset = 0.8 * radius * even(random);
    if (shade < 1) {
      picture.light = [=](double x, double y) {
        const double distance =
            (x - picture.x) * std::cos(angle) + (y - picture.y) * std::sin(angle) - offset;
        return shade + (1 - shade) * detector::testing::softStep(distance, 1.5);
      };
    }
    out.push_back({detector::testing::shoot(picture, random),
                   {picture.x + 0.3 * even(random), picture.y + 0.3 * even(random)},
                   picture.shape});
  }
  return out;
}

void fitAll(benchmark::State& state, double scale, double shade) {
  const std::vector<Shot> all = shots(scale, shade);
  int edges = 0;
  for (auto _ : state) {
    edges = 0;
    for (const Shot& shot : all) {
      const detector::CircleFit fit =
          detector::fitCircle(shot.image.view(), shot.start, shot.shape, {});
      edges += fit.edge ? 1 : 0;
      benchmark::DoNotOptimize(fit.x);
    }
  }
  state.counters["edges"] = edges;
  state.SetItemsProcessed(state.iterations() * kCircles);
}

void evenLight(benchmark::State& state) { fitAll(state, 1.0, 1.0); }
void evenLight1080(benchmark::State& state) { fitAll(state, 1.49, 1.0); }
void halfPlanes(benchmark::State& state) { fitAll(state, 1.0, 0.3); }

// Baseline: reads every pixel of the same windows once.
void readOnly(benchmark::State& state) {
  const std::vector<Shot> all = shots(1.0, 1.0);
  for (auto _ : state) {
    unsigned sum = 0;
    for (const Shot& shot : all) {
      for (int y = 14; y <= 34; ++y) {
        const std::uint8_t* row = shot.image.view().row(y);
        for (int x = 14; x <= 34; ++x) sum += row[x];
      }
    }
    benchmark::DoNotOptimize(sum);
  }
  state.SetItemsProcessed(state.iterations() * kCircles);
}

}  // namespace

BENCHMARK(readOnly);
BENCHMARK(evenLight);
BENCHMARK(evenLight1080);
BENCHMARK(halfPlanes);
BENCHMARK_MAIN();
