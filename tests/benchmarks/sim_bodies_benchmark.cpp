// Cost of robots on serial lines in the simulator, in virtual time: native ones (firmware::Device
// on the host) and ones on simulated chips (robot_emulator). With lines at 38400 baud, a host that
// renews the lease, telemetry, step log, sensors and collisions. Counters: robot-seconds per
// second, and the time of a slice of 2 ms (with chips, most of the work is done by the other
// process meanwhile).
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/loop/virtual_loop.hpp"
#include "common/serial/memory_serial.hpp"
#include "sim_svc/bodies/chip_robots.hpp"
#include "sim_svc/bodies/external_robots.hpp"
#include "sim_svc/bodies/wire_robots.hpp"
#include "tests/support/wire_host.hpp"
#include "tests/support/world_fixture.hpp"

namespace {

using namespace lab;
using namespace lab::sim;
namespace fs = std::filesystem;

/// Robots with the density of 20 in the real arena, and their hosts.
class Bench {
 public:
  explicit Bench(std::size_t robots) : world_(settings(robots), setups(robots)) {
    world_.setLight(&light_);
    loop_.every(ExternalRobots::kSlice_us, start_, [this] { follow(); });
  }

  World& world() { return world_; }
  void add(std::unique_ptr<BodyDriver> driver) { outer_.add(std::move(driver)); }

  void begin() {
    for (const std::string& name : ports_.offered()) {
      hosts_.push_back(std::make_unique<WireHost>(ports_, name));
    }
    run(1'500'000);
    for (const auto& host : hosts_) host->configure(always(abpProgram()), 1);
    loop_.every(200'000, loop_.now(), [this] {
      for (const auto& host : hosts_) {
        host->frames.clear();
        host->bytes.clear();
        host->run(1000);
      }
    });
    run(1'000'000);
  }

  void run(std::int64_t us) { loop_.runUntil(loop_.now() + us); }

 private:
  static WorldSettings settings(std::size_t robots) {
    const double scale = std::sqrt(static_cast<double>(robots) / 20);
    WorldSettings settings;
    settings.arena.width *= std::max(1.0, scale);
    settings.arena.height *= std::max(1.0, scale);
    return settings;
  }

  static std::vector<RobotSetup> setups(std::size_t robots) {
    std::vector<RobotSetup> setups;
    for (std::size_t i = 0; i < robots; ++i) {
      setups.push_back({static_cast<std::int32_t>(i + 1), std::nullopt, true});
    }
    return setups;
  }

  void follow() { outer_.advanceTo(loop_.now() - start_); }

  VirtualLoop loop_;
  std::int64_t start_ = loop_.now();
  MemorySerial ports_{loop_};
  StepLight light_{0.6, 0.3, 0.7};
  World world_;
  ExternalRobots outer_{world_, ports_, [this] { follow(); }};
  std::vector<std::unique_ptr<WireHost>> hosts_;
};

void measure(benchmark::State& state, Bench& bench, std::size_t robots) {
  bench.begin();
  std::int64_t slices = 0;
  for (auto _ : state) {
    bench.run(100'000);
    slices += 100'000 / ExternalRobots::kSlice_us;
  }
  using benchmark::Counter;
  const double slice_s = static_cast<double>(ExternalRobots::kSlice_us) * 1e-6;
  const double seconds = static_cast<double>(slices) * slice_s;
  state.counters["robot_s_per_s"] =
      Counter(seconds * static_cast<double>(robots), Counter::kIsRate);
  state.counters["s_per_slice"] =
      Counter(static_cast<double>(slices), Counter::kIsRate | Counter::kInvert);
}

void wireRobots(benchmark::State& state) {
  const auto robots = static_cast<std::size_t>(state.range(0));
  Bench bench(robots);
  std::vector<WireSetup> setups;
  for (std::size_t i = 0; i < robots; ++i) {
    WireSetup setup;
    setup.body = i;
    setup.settings.uid = static_cast<std::uint32_t>(1 + i);
    setups.push_back(setup);
  }
  bench.add(std::make_unique<WireRobots>(bench.world(), setups));
  measure(state, bench, robots);
}

void chipRobots(benchmark::State& state) {
  const fs::path programs = fs::canonical("/proc/self/exe").parent_path();
  if (!fs::exists(programs / "robot_emulator")) {
    state.SkipWithError("robot_emulator is not built");
    return;
  }
  const auto robots = static_cast<std::size_t>(state.range(0));
  Bench bench(robots);
  std::vector<ChipRobotSetup> setups;
  for (std::size_t i = 0; i < robots; ++i) setups.push_back({i, {}});
  std::string failure;
  bench.add(std::make_unique<ChipRobots>(bench.world(), std::move(setups), programs,
                                         [&failure](const std::string& what) { failure = what; }));
  measure(state, bench, robots);
  if (!failure.empty()) state.SkipWithError(failure.c_str());
}

BENCHMARK(wireRobots)->Arg(1)->Arg(20)->Arg(100)->Arg(500)->UseRealTime();
BENCHMARK(chipRobots)->Arg(1)->Arg(2)->Arg(10)->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
