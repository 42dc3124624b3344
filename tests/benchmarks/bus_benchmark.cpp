// Cost of bus, loop and nodes. In virtual time a lab sends about 150 messages per simulated second,
// so at 500 times real time each message may take 13 us in all.
#include <benchmark/benchmark.h>

#include <cstdint>
#include <lab/robot_status_t.hpp>
#include <string>

#include "common/bus/channels.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/loop/virtual_loop.hpp"
#include "common/service/node.hpp"

namespace {

using lab::robot_status_t;
namespace channels = lab::channels;

robot_status_t statusOf(std::int64_t robots) {
  robot_status_t status{};
  for (std::int32_t id = 0; id < robots; ++id) {
    lab::robot_state_t robot{};
    robot.robot_id = id;
    robot.program.hash = 0x89ABCDEF;
    robot.program.name = "abp";
    robot.wheel_left = 0.1;
    status.robots.push_back(robot);
  }
  status.num_robots = static_cast<std::int32_t>(status.robots.size());
  return status;
}

/// A sender, receivers that decode, and one that takes the bytes, as the logger does.
struct Lab {
  explicit Lab(std::int64_t listeners) : node(bus, loop, {"sim_svc"}) {
    for (std::int64_t i = 0; i < listeners; ++i) {
      node.subscribe<robot_status_t>(channels::kRobotStatus, [this](const robot_status_t& status) {
        heard += status.num_robots;
      });
    }
    bus.subscribeAll([this](const lab::Packet& packet) { bytes += packet.data.size(); });
  }
  lab::VirtualLoop loop;
  lab::MemoryBus bus{[this] { return loop.now(); }};
  lab::Node node;
  std::int64_t heard = 0;
  std::size_t bytes = 0;
};

/// Arguments: robots, decoding receivers.
void publishAndDeliver(benchmark::State& state) {
  Lab lab(state.range(1));
  robot_status_t status = statusOf(state.range(0));
  for (auto _ : state) {
    lab.node.publish(channels::kRobotStatus, status);
    lab.bus.deliver();
  }
  benchmark::DoNotOptimize(lab.heard);
  benchmark::DoNotOptimize(lab.bytes);
}
BENCHMARK(publishAndDeliver)->ArgsProduct({{1, 20}, {0, 1, 3}});

/// LCM's codec alone, for comparison.
void encodeAndDecode(benchmark::State& state) {
  const robot_status_t status = statusOf(state.range(0));
  for (auto _ : state) {
    robot_status_t heard{};
    benchmark::DoNotOptimize(lab::decode(lab::encode(status), heard));
  }
}
BENCHMARK(encodeAndDecode)->Arg(1)->Arg(20);

/// One event in virtual time with 20 timers.
void virtualTimeStep(benchmark::State& state) {
  lab::VirtualLoop loop;
  std::int64_t calls = 0;
  for (std::int64_t i = 0; i < 20; ++i) loop.every(20'000 + i, loop.now(), [&calls] { ++calls; });
  for (auto _ : state) loop.runUntil(loop.now() + 1'000);
  state.SetItemsProcessed(calls);
}
BENCHMARK(virtualTimeStep);

}  // namespace

BENCHMARK_MAIN();
