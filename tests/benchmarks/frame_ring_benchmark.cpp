// Latency of the simulated camera's shared memory: from show() in one process to the handler in
// another. For comparison a copy of the frame, and a frame of one pixel, which is only the wake-up.
#include <benchmark/benchmark.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "common/math/percentiles.hpp"
#include "tracker_svc/camera_devices.hpp"

namespace {

constexpr std::size_t kFrames = 1500;
constexpr std::int64_t kPeriod_us = 2000;

std::int64_t steady_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

lab::CameraFormat sized(const benchmark::State& state) {
  lab::CameraFormat format;
  format.width = static_cast<int>(state.range(0));
  format.height = static_cast<int>(state.range(1));
  return format;
}

std::filesystem::path labFolder() {
  return std::filesystem::temp_directory_path() /
         ("lab_ring_benchmark_" + std::to_string(getpid()));
}

/// A process that shows a painted frame per period, time-stamped with the steady clock [ns].
pid_t startPainter(const lab::CameraFormat& format, const std::filesystem::path& folder) {
  const pid_t pid = fork();
  if (pid != 0) return pid;
  lab::AsioLoop loop;
  lab::CameraDevices cameras(loop, folder);
  const auto sink = cameras.offer(format);
  std::int64_t number = 0;
  loop.every(kPeriod_us, loop.now(), [&] {
    if (!sink->isWatched()) return;
    const auto canvas = sink->canvas();
    std::memset(canvas.data(), static_cast<int>(number & 0xff), canvas.size());
    sink->show(number++, steady_ns());
  });
  loop.run();
  _exit(0);
}

/// Microseconds from show() to the handler.
void ringLatency(benchmark::State& state) {
  std::vector<double> latencies;
  std::int64_t dropped = 0;
  for (auto _ : state) {
    latencies.clear();
    const std::filesystem::path folder = labFolder();
    const pid_t painter = startPainter(sized(state), folder);
    lab::AsioLoop loop;
    lab::CameraDevices cameras(loop, folder);
    lab::CameraHandlers handlers;
    handlers.frame = [&](const lab::CameraFrame& frame) {
      latencies.push_back(static_cast<double>(steady_ns() - frame.utime) * 1e-3);
      if (latencies.size() >= kFrames) loop.stop();
    };
    const auto source = cameras.open("sim", sized(state), handlers);
    loop.run();
    dropped = source->dropped();
    kill(painter, SIGKILL);
    waitpid(painter, nullptr, 0);
  }
  const lab::Percentiles latency = lab::percentilesOf(latencies);
  state.counters["p50_us"] = latency.p50;
  state.counters["p95_us"] = latency.p95;
  state.counters["p99_us"] = latency.p99;
  state.counters["dropped"] = static_cast<double>(dropped);
}

/// The copy that shared memory saves, of a frame that is not in the cache.
void frameCopy(benchmark::State& state) {
  const auto bytes = static_cast<std::size_t>(state.range(0) * state.range(1));
  std::vector<std::uint8_t> from(64 * bytes, 1);
  std::vector<std::uint8_t> to(bytes);
  std::size_t frame = 0;
  for (auto _ : state) {
    std::memcpy(to.data(), from.data() + (frame++ % 64) * bytes, bytes);
    benchmark::ClobberMemory();
  }
}

}  // namespace

BENCHMARK(ringLatency)
    ->Args({1, 1})
    ->Args({1280, 720})
    ->Args({1920, 1080})
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(frameCopy)->Args({1280, 720})->Args({1920, 1080})->Unit(benchmark::kMicrosecond);
BENCHMARK_MAIN();
