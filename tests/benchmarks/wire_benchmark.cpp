// Cost of a frame on the host: a bridge with 40 robots decodes about 1000 per second.
#include <benchmark/benchmark.h>

#include <array>
#include <cstdint>
#include <cstring>

#include "robot/wire/config.hpp"
#include "robot/wire/frame.hpp"
#include "robot/wire/messages.hpp"

namespace {

using lab::wire::Decoder;
using lab::wire::Frame;
using lab::wire::Telemetry;

Telemetry someTelemetry() {
  Telemetry telemetry;
  telemetry.t_ms = 123456;
  telemetry.left_um_s = -50000;
  telemetry.right_um_s = 50000;
  for (std::uint16_t i = 0; i < 8; ++i) telemetry.sensors[i] = static_cast<std::uint16_t>(120 * i);
  telemetry.config = 0xBEEF;
  return telemetry;
}

Frame frameOfSize(std::int64_t size) {
  Frame frame;
  frame.type = 0x90;
  frame.size = static_cast<std::uint8_t>(size);
  for (std::uint8_t i = 0; i < frame.size; ++i) {
    frame.payload[i] = static_cast<std::uint8_t>(i % 3 == 0 ? 0 : i);
  }
  return frame;
}

void countBytes(benchmark::State& state, std::int64_t bytes) {
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) * bytes);
}

void encodeFrame(benchmark::State& state) {
  Frame frame = frameOfSize(state.range(0));
  std::array<std::uint8_t, lab::wire::kMaxFrame> bytes{};
  std::uint8_t size = 0;
  for (auto _ : state) {
    ++frame.seq;
    size = lab::wire::encode(frame, bytes.data());
    benchmark::DoNotOptimize(bytes);
  }
  countBytes(state, size);
}
BENCHMARK(encodeFrame)->Arg(0)->Arg(16)->Arg(32)->Arg(40);

void decodeFrame(benchmark::State& state) {
  std::array<std::uint8_t, lab::wire::kMaxFrame> bytes{};
  const std::uint8_t size = lab::wire::encode(frameOfSize(state.range(0)), bytes.data());
  Decoder decoder;
  for (auto _ : state) {
    bool complete = false;
    for (std::uint8_t i = 0; i < size; ++i) complete = decoder.push(bytes[i]);
    if (!complete) state.SkipWithError("the frame was not accepted");
    benchmark::DoNotOptimize(decoder);
  }
  countBytes(state, size);
}
BENCHMARK(decodeFrame)->Arg(0)->Arg(16)->Arg(32)->Arg(40);

/// Baseline: copies a frame.
void copyFrame(benchmark::State& state) {
  std::array<std::uint8_t, lab::wire::kMaxFrame> from{};
  std::array<std::uint8_t, lab::wire::kMaxFrame> to{};
  const auto size = static_cast<std::size_t>(state.range(0)) + lab::wire::kFrameOverhead;
  for (auto _ : state) {
    benchmark::DoNotOptimize(from);
    std::memcpy(to.data(), from.data(), size);
    benchmark::DoNotOptimize(to);
  }
  countBytes(state, static_cast<std::int64_t>(size));
}
BENCHMARK(copyFrame)->Arg(32);

void packTelemetry(benchmark::State& state) {
  Telemetry telemetry = someTelemetry();
  Frame frame;
  for (auto _ : state) {
    benchmark::DoNotOptimize(telemetry);
    lab::wire::pack(telemetry, 1, frame);
    benchmark::DoNotOptimize(frame);
  }
}
BENCHMARK(packTelemetry);

void unpackTelemetry(benchmark::State& state) {
  Frame frame;
  lab::wire::pack(someTelemetry(), 1, frame);
  Telemetry telemetry;
  for (auto _ : state) {
    benchmark::DoNotOptimize(frame);
    if (!lab::wire::unpack(frame, telemetry)) state.SkipWithError("the frame was not read");
    benchmark::DoNotOptimize(telemetry);
  }
}
BENCHMARK(unpackTelemetry);

void crcOfSettings(benchmark::State& state) {
  lab::dynamics::CoreSettings settings;
  for (auto _ : state) {
    ++settings.reversal.distance_um;
    benchmark::DoNotOptimize(lab::wire::configCrc(settings));
  }
}
BENCHMARK(crcOfSettings);

}  // namespace

BENCHMARK_MAIN();
