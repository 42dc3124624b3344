// The firmware binary on a simulated chip: round trips in simulated time, compared with the time on
// the line alone, and the number of robots that one core runs in real time.
//
// Linked with libsimavr: GPL-3.0-or-later as a whole, see sim_svc/emulator/LICENSE.md.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "common/math/random.hpp"
#include "common/programs/shipped_programs.hpp"
#include "robot/firmware/program_store.hpp"
#include "robot/firmware/settings.hpp"
#include "robot/wire/config.hpp"
#include "robot/wire/fields.hpp"
#include "sim_svc/emulator/chip.hpp"

namespace {

using namespace lab;
using emulator::Chip;

constexpr double kCyclesPerMs = emulator::kChipHz / 1000;
constexpr double kHostBaud = 38400;

std::shared_ptr<const emulator::FirmwareImage> program() {
  static const auto shipped = std::make_shared<const emulator::FirmwareImage>(LAB_FIRMWARE_ELF);
  return shipped;
}

/// A host that answers at once.
class Host {
 public:
  explicit Host(Chip& chip, const Program& program = {}) : chip_(chip) {
    std::vector<std::uint8_t> store(firmware::kStoreSize);
    firmware::Settings settings;
    settings.uid = 1;
    firmware::encodeStore(settings, store.data());
    if (program.hash != 0) {
      firmware::encodeProgram(program.code.data(), static_cast<std::uint8_t>(program.code.size()),
                              0, store.data());
    }
    chip_.loadEeprom(store);
    chip_.switchOn();
    run(100);
  }

  void run(double ms) {
    ms_ += ms;
    const auto cycle = static_cast<std::uint64_t>(std::llround(ms_ * kCyclesPerMs));
    chip_.runTo(cycle);
    for (const auto& byte : chip_.takeSent(cycle)) {
      if (decoder_.push(byte.value)) {
        last_frame_ = decoder_.frame();
        last_ms_ = static_cast<double>(byte.cycle) / kCyclesPerMs;
        if (last_frame_.seq == seq_ &&
            (last_frame_.type == wire::Ack::kType || last_frame_.type == wire::Pong::kType)) {
          answered_ms_ = last_ms_;
        }
      }
    }
  }

  /// @return time until the answer [ms]
  template <class Message>
  double ask(const Message& message) {
    wire::Frame frame;
    wire::pack(message, ++seq_, frame);
    std::uint8_t bytes[wire::kMaxFrame];
    const std::uint8_t size = wire::encode(frame, bytes);
    answered_ms_ = -1;
    const double asked = ms_;
    chip_.receive(std::span<const std::uint8_t>(bytes, size));
    while (answered_ms_ < 0 && ms_ < asked + 1000) run(0.5);
    return answered_ms_ - asked;
  }

 private:
  Chip& chip_;
  double ms_ = 0;
  wire::Decoder decoder_;
  wire::Frame last_frame_;
  double last_ms_ = 0;
  double answered_ms_ = -1;
  std::uint8_t seq_ = 0;
};

double wireMs(std::size_t request, std::size_t reply, double robot_baud) {
  const auto overhead = static_cast<double>(wire::kFrameOverhead);
  return 1e4 * ((static_cast<double>(request) + overhead) / kHostBaud +
                (static_cast<double>(reply) + overhead) / robot_baud);
}

template <class Request, class Reply>
void roundTrip(benchmark::State& state, const Request& request) {
  constexpr int kTrips = 400;
  Random random(1);
  std::vector<double> trips;
  double wire_ms = 0;
  for (auto _ : state) {
    Chip chip(program());
    Host host(chip);
    host.ask(wire::SetParam{wire::kTelemetryPeriod, 0});
    host.run(500);
    for (int i = 0; i < kTrips; ++i) {
      host.run(60 + 40 * random.uniform());
      trips.push_back(host.ask(request));
    }
    wire_ms = wireMs(wire::payloadSize<Request>(), wire::payloadSize<Reply>(), chip.baud());
  }
  std::sort(trips.begin(), trips.end());
  const double p50 = trips[trips.size() / 2];
  state.counters["wire_ms"] = wire_ms;
  state.counters["p50_ms"] = p50;
  state.counters["p95_ms"] = trips[trips.size() * 95 / 100];
  state.counters["p50_over_wire"] = p50 / wire_ms;
}

void pingRoundTrip(benchmark::State& state) {
  roundTrip<wire::Ping, wire::Pong>(state, wire::Ping{0x01020304, 0x05060708});
}
BENCHMARK(pingRoundTrip)->Unit(benchmark::kMillisecond)->Iterations(1);

void orderRoundTrip(benchmark::State& state) {
  wire::Order order;
  order.lease_ms = 500;
  roundTrip<wire::Order, wire::Ack>(state, order);
}
BENCHMARK(orderRoundTrip)->Unit(benchmark::kMillisecond)->Iterations(1);

/// Robots in slices of 2 ms, each with telemetry at 20 Hz, a program and its step log.
void robotsPerCore(benchmark::State& state) {
  constexpr double kSliceMs = 2;
  const auto robots = static_cast<std::size_t>(state.range(0));
  dynamics::CoreSettings settings;
  const Program abp = shippedProgram("abp");
  settings.programs[0] = abp.hash;
  settings.light.count = 1;
  settings.light.bands[0].high = dynamics::kLightCounts;
  std::vector<std::unique_ptr<Chip>> chips;
  std::vector<std::unique_ptr<Host>> hosts;
  for (std::size_t i = 0; i < robots; ++i) {
    chips.push_back(std::make_unique<Chip>(program()));
    hosts.push_back(std::make_unique<Host>(*chips.back(), abp));
    Host& host = *hosts.back();
    for (std::uint8_t slot = 0; slot < dynamics::kSlots; ++slot) {
      host.ask(wire::programMessage(settings, slot));
    }
    host.ask(wire::lightMessage(settings));
    host.ask(wire::motionMessage(settings));
    host.ask(wire::Apply{wire::configCrc(settings)});
    wire::Order order;
    order.mode = wire::Order::kTable;
    order.config = wire::configCrc(settings);
    order.lease_ms = 1U << 30U;
    host.ask(order);
  }
  double simulated_s = 0;
  for (auto _ : state) {
    for (const auto& host : hosts) host->run(kSliceMs);
    simulated_s += static_cast<double>(robots) * kSliceMs / 1000;
  }
  state.counters["robots_per_core"] = benchmark::Counter(simulated_s, benchmark::Counter::kIsRate);
}
BENCHMARK(robotsPerCore)->Arg(1)->Arg(10)->Arg(40);

}  // namespace

BENCHMARK_MAIN();
