// Cost of one frame: MSD and angular MSD at 57 lags, compared with a write to a ring buffer; of one
// hour, compared with the MSD at all lags by Fourier transforms; of one second of 100 robots in the
// analyzer.
#include <benchmark/benchmark.h>

#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "analyzer/analysis_feed.hpp"
#include "analyzer/curves/lags.hpp"
#include "analyzer/curves/msd_accumulator.hpp"
#include "common/experiment/program_messages.hpp"
#include "tests/support/programs.hpp"

namespace lab::analysis {
namespace {

constexpr double kFramePeriod = 0.01;  // [s]
constexpr double kMaxLag = 100;        // [s]

ProgramLaw program() { return lawOf(test::abp(0.03, 0.5, 3), kPaperWheelBase); }

/// A recording of an active Brownian robot with a removed reversal every `piece` frames.
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

using Complex = std::complex<double>;

/// In-place radix-2 FFT; the size must be a power of two.
void fourier(std::vector<Complex>& data) {
  const std::size_t n = data.size();
  for (std::size_t i = 1, j = 0; i < n; ++i) {
    std::size_t bit = n >> 1U;
    for (; (j & bit) != 0; bit >>= 1U) j ^= bit;
    j ^= bit;
    if (i < j) std::swap(data[i], data[j]);
  }
  std::vector<Complex> roots(n / 2);
  for (std::size_t k = 0; k < n / 2; ++k) {
    roots[k] =
        std::polar(1.0, -2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n));
  }
  for (std::size_t length = 2; length <= n; length *= 2) {
    const std::size_t step = n / length;
    for (std::size_t begin = 0; begin < n; begin += length) {
      for (std::size_t k = 0; k < length / 2; ++k) {
        const Complex root = roots[k * step];
        const Complex& b = data[begin + k + length / 2];
        const Complex turned{root.real() * b.real() - root.imag() * b.imag(),
                             root.real() * b.imag() + root.imag() * b.real()};
        const Complex a = data[begin + k];
        data[begin + k] = a + turned;
        data[begin + k + length / 2] = a - turned;
      }
    }
  }
}

/// The MSD at all lags: squares by cumulative sums, products by the autocorrelation of x + iy.
std::vector<double> allLagsMsd(const std::vector<Sample>& samples) {
  const std::size_t n = samples.size();
  std::vector<Complex> data(std::size_t{1} << 20U);
  double squares = 0;
  for (std::size_t i = 0; i < n; ++i) {
    data[i] = {samples[i].x, samples[i].y};
    squares += 2 * std::norm(data[i]);
  }
  fourier(data);
  for (Complex& value : data) value = std::norm(value);
  fourier(data);  // the spectrum is real and even, so this is the inverse up to a factor
  std::vector<double> msd(n);
  for (std::size_t lag = 0; lag < n; ++lag) {
    if (lag > 0) {
      const Sample& first = samples[lag - 1];
      const Sample& last = samples[n - lag];
      squares -= first.x * first.x + first.y * first.y + last.x * last.x + last.y * last.y;
    }
    msd[lag] = (squares - 2 * data[lag].real() / static_cast<double>(data.size())) /
               static_cast<double>(n - lag);
  }
  return msd;
}

void BM_AllLagsMsdByFourier(benchmark::State& state) {
  const std::vector<Sample> samples = film(360000, 1 << 30);
  for (auto _ : state) {
    benchmark::DoNotOptimize(allLagsMsd(samples).data());
  }
}
BENCHMARK(BM_AllLagsMsdByFourier)->Unit(benchmark::kMillisecond);

/// Messages of robots that run ABP.
class Crowd {
 public:
  explicit Crowd(int robots) : headings_(static_cast<std::size_t>(robots)) {
    frame_.frame_period = kFramePeriod;
    frame_.num_robots = status_.num_robots = robots;
    frame_.robots.resize(headings_.size());
    status_.robots.resize(headings_.size());
    const program_id_t abp = toId(test::abp(0.03, 0.5, 3));
    for (std::size_t i = 0; i < headings_.size(); ++i) {
      robot_state_t& state = status_.robots[i];
      state.robot_id = frame_.robots[i].robot_id = static_cast<std::int32_t>(i) + 1;
      frame_.robots[i].confidence = 1;
      state.program = abp;
      state.program_epoch = 1;
      state.program_start_utime = kStart;
    }
  }

  /// Advances by one frame (100 per second); telemetry is sent at 50 per second.
  void feed(AnalysisFeed& feed) {
    frame_.utime = status_.utime = kStart + 10'000 * ++frame_.frame;
    for (std::size_t i = 0; i < headings_.size(); ++i) {
      if (frame_.frame % 50 == 1) rates_[i % 256] = turning_(random_);
      headings_[i] += kFramePeriod * rates_[i % 256];
      tracked_pose_t& pose = frame_.robots[i];
      pose.x += 0.03 * kFramePeriod * std::cos(headings_[i]);
      pose.y += 0.03 * kFramePeriod * std::sin(headings_[i]);
      pose.theta = std::remainder(headings_[i], 2 * std::numbers::pi);
      status_.robots[i].utime = frame_.utime;
    }
    feed.take(frame_);
    if (frame_.frame % 2 == 0) feed.take(status_);
  }

 private:
  static constexpr std::int64_t kStart = 1'700'000'000'000'000;
  tracked_frame_t frame_{};
  robot_status_t status_{};
  std::vector<double> headings_;
  std::vector<double> rates_ = std::vector<double>(256);
  std::mt19937_64 random_{1};
  std::uniform_real_distribution<double> turning_{-3, 3};
};

/// One second of 100 robots at 100 frames/s after ten minutes: frames, telemetry and the results
/// that the analyzer publishes once per second. The time includes the simulated robots.
void BM_SecondOfHundredRobots(benchmark::State& state) {
  Experiment experiment;
  experiment.programs["abp"] = test::abp(0.03, 0.5, 3);
  AnalysisFeed feed{experiment};
  Crowd crowd(100);
  for (int i = 0; i < 60000; ++i) crowd.feed(feed);
  for (auto _ : state) {
    for (int i = 0; i < 100; ++i) crowd.feed(feed);
    if (state.range(0) != 0) benchmark::DoNotOptimize(feed.results().data());
  }
  state.counters["share_of_core"] = benchmark::Counter(
      1, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(BM_SecondOfHundredRobots)
    ->ArgName("results")
    ->Arg(0)
    ->Arg(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lab::analysis

BENCHMARK_MAIN();
