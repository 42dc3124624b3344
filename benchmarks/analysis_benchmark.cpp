// The cost of one frame: MSD and angular MSD at 57 lags beside the bare write of a ring buffer.
#include <benchmark/benchmark.h>

#include <cmath>
#include <random>
#include <vector>

#include "analyzer/lags.hpp"
#include "analyzer/msd_accumulator.hpp"

namespace lab::analysis {
namespace {

constexpr double kFramePeriod = 0.01;  // s
constexpr double kMaxLag = 100;        // s

ProgramLaw program() {
  ProgramLaw law;
  law.kind = ProgramKind::kAbp;
  law.v = 0.03;
  law.eta = 3;
  law.epsilon = 0.5;
  return law;
}

/// One film: an active Brownian robot, cut by a removed reversal every `piece` frames.
std::vector<Sample> film(int frames, int piece) {
  std::vector<Sample> samples;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> turning(-3, 3);
  Sample sample;
  double rate = 0;
  for (int i = 0; i < frames; ++i) {
    rate = i % 50 == 0 ? turning(random) : rate;
    sample.free_time = kFramePeriod * i;
    sample.time = sample.free_time;
    sample.x += 0.03 * kFramePeriod * std::cos(sample.theta);
    sample.y += 0.03 * kFramePeriod * std::sin(sample.theta);
    sample.theta += rate * kFramePeriod;
    sample.piece = i / piece;
    samples.push_back(sample);
  }
  return samples;
}

void BM_RingBufferWrite(benchmark::State& state) {
  const std::vector<Sample> samples = film(360000, 1 << 30);
  std::vector<Sample> ring(1 << 14);
  for (auto _ : state) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      ring[i & (ring.size() - 1)] = samples[i];
    }
    benchmark::DoNotOptimize(ring.data());
  }
  state.SetItemsProcessed(state.iterations() * 360000);
}
BENCHMARK(BM_RingBufferWrite)->Unit(benchmark::kMillisecond);

/// One hour at 100 frames/s; the argument is the number of frames between reversals.
void BM_MsdAndAngularMsd(benchmark::State& state) {
  const std::vector<Sample> samples = film(360000, static_cast<int>(state.range(0)));
  const std::vector<int> lags = makeLagGrid(kFramePeriod, kMaxLag, program());
  for (auto _ : state) {
    MsdAccumulator accumulator(lags, kFramePeriod);
    for (const Sample& sample : samples) {
      accumulator.add(sample);
    }
    benchmark::DoNotOptimize(accumulator.data().tracks.data());
  }
  state.SetItemsProcessed(state.iterations() * 360000);
  state.counters["lags"] = static_cast<double>(lags.size());
  state.counters["time_per_frame"] = benchmark::Counter(
      360000, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(BM_MsdAndAngularMsd)->Arg(1 << 30)->Arg(7000)->Arg(2000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lab::analysis

BENCHMARK_MAIN();
