// Robots on the wire without a chip, over lines in memory and in virtual time.
#include "sim_svc/bodies/wire_robots.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "common/loop/virtual_loop.hpp"
#include "common/math/random.hpp"
#include "common/serial/memory_serial.hpp"
#include "sim_svc/bodies/external_robots.hpp"
#include "tests/support/wire_host.hpp"
#include "tests/support/world_fixture.hpp"

namespace lab::sim {
namespace {

constexpr std::uint32_t kUid = 0x51000007;

std::vector<RobotSetup> wireRobotAt(double x, double y, double theta) {
  return {{7, dynamics::Pose{x, y, theta}, true}};
}

WireSetup wireSetup(std::size_t body = 0, int baud = 38400) {
  WireSetup setup;
  setup.body = body;
  setup.baud = baud;
  setup.settings.uid = kUid;
  return setup;
}

/// A world with wire robots that follows virtual time, as in the service.
struct Bench {
  explicit Bench(const WorldSettings& settings = idealHardware(),
                 std::vector<RobotSetup> setups = wireRobotAt(0.6, 0.45, 0), int baud = 38400)
      : world(settings, setups) {
    world.setLight(&light);
    std::vector<WireSetup> wire;
    for (std::size_t i = 0; i < world.size(); ++i) wire.push_back(wireSetup(i, baud));
    auto driver = std::make_unique<WireRobots>(world, wire);
    robots = driver.get();
    outer.add(std::move(driver));
    loop.every(ExternalRobots::kSlice_us, start, [this] { follow(); });
  }

  void follow() { outer.advanceTo(loop.now() - start); }
  void run(double seconds) { loop.runUntil(loop.now() + std::llround(seconds * 1e6)); }
  /// Loads the program into the robot, and makes it the one for any light.
  void configure(WireHost& host, const Program& program, std::uint64_t seed) {
    host.load(program);
    run(1);
    host.configure(always(program), seed);
  }

  VirtualLoop loop;
  std::int64_t start = loop.now();
  MemorySerial ports{loop};
  StepLight light{0.6, 0.5, 0.5};
  World world;
  ExternalRobots outer{world, ports, [this] { follow(); }};
  WireRobots* robots = nullptr;
};

TEST(WireRobots, OfferOneLineEachAndSendHelloEverySecondUntilAHostSendsAFrame) {
  Bench bench;
  EXPECT_EQ(bench.ports.offered(), std::vector<std::string>{"robot_07"});
  WireHost host(bench.ports, "robot_07");
  bench.run(3.5);
  const auto hellos = host.all<wire::Hello>();
  ASSERT_EQ(hellos.size(), 4U);
  EXPECT_EQ(hellos[0].uid, kUid);
  EXPECT_EQ(hellos[0].baud, 38400U);
  EXPECT_EQ(hellos[0].reset_cause, wire::kResetPower);
  EXPECT_EQ(hellos[3].boot_id, hellos[0].boot_id);
  host.send(wire::GetInfo());
  bench.run(3);
  EXPECT_EQ(host.all<wire::Hello>().size(), 5U) << "only the answer";
}

TEST(WireRobots, TheLineDelaysBytesInBothDirections) {
  Bench bench;
  WireHost host(bench.ports, "robot_07");
  bench.run(0.5);
  host.send(wire::GetInfo());
  bench.run(0.2);
  const std::size_t before = host.bytes.size();
  host.send(wire::Ping());
  // PING has 17 bytes and PONG 23: 40 bytes of 10 bits of 26 us take 10.4 ms. Another report of the
  // robot and one slice may add to this.
  bench.run(0.010);
  EXPECT_EQ(host.all<wire::Pong>().size(), 0U);
  bench.run(0.040);
  EXPECT_EQ(host.all<wire::Pong>().size(), 1U);
  const double line_s = static_cast<double>(host.bytes.size() - before) * 10 / 38400;
  EXPECT_LE(line_s, 0.050);
}

TEST(WireRobots, ABusyLineCarriesWholeFramesAtItsSpeed) {
  // At 9600 baud and 100 reports per second, most reports find the line busy.
  Bench bench(idealHardware(), wireRobotAt(0.6, 0.45, 0), 9600);
  WireHost host(bench.ports, "robot_07");
  wire::SetParam fast;
  fast.id = wire::kTelemetryPeriod;
  fast.value = 10;
  host.send(fast);
  bench.run(5);
  wire::Decoder decoder;
  for (const std::uint8_t byte : host.bytes) static_cast<void>(decoder.push(byte));
  EXPECT_EQ(decoder.counts().crc, 0);
  EXPECT_EQ(decoder.counts().malformed, 0);
  EXPECT_LE(host.bytes.size(), 5U * 960 + 1);
  EXPECT_GT(host.bytes.size(), 5U * 960 / 2);
}

TEST(WireRobots, DriveAtTheOrderedSpeed) {
  Bench bench(idealHardware(), wireRobotAt(0.3, 0.45, 0));
  WireHost host(bench.ports, "robot_07");
  bench.configure(host, abpProgram(), 1);
  bench.run(0.2);
  const dynamics::Pose before = bench.world.pose(0);
  host.order.mode = wire::Order::kDrive;
  host.order.left_um_s = 90000;  // a third of the full speed: exactly duty 85
  host.order.right_um_s = 90000;
  host.order.lease_ms = 1000;
  host.send(host.order);
  bench.run(3);
  // The lease starts at the end of the frame; both ends are within a millisecond of the robot's
  // clock.
  EXPECT_NEAR(bench.world.pose(0).x - before.x, 0.09, 0.09 * 0.002);
  EXPECT_EQ(bench.world.pose(0).y, before.y);
}

TEST(WireRobots, DrawTheSameAsABusRobotWithTheSameSeed) {
  constexpr std::uint64_t kSeed = 11;
  WorldSettings settings;
  settings.seed = kSeed;
  settings.arena = {20, 20};
  const Program program = abpProgram(0.03, 0.1, 3);

  std::vector<dynamics::WheelSpeedsUmS> on_bus;
  std::vector<RobotSetup> setups = wireRobotAt(10, 10, 0);
  setups[0].external = false;
  World bus(settings, setups);
  const StepLight light(0.6, 0.5, 0.5);
  bus.setLight(&light);
  startAll(bus, always(program));
  std::uint32_t draws = 0;
  while (on_bus.size() < 300) {
    bus.step(1000);
    const dynamics::CoreReport report = bus.core(0).report();
    if (report.program == program.hash && report.draw_count != draws) on_bus.push_back(report.held);
    draws = report.draw_count;
  }

  Bench bench(settings, wireRobotAt(10, 10, 0));
  WireHost host(bench.ports, "robot_07");
  bench.run(1.1);  // until it is switched on
  bench.configure(host, program, deriveSeed(kSeed, 7, "program"));
  host.run(60'000);
  bench.run(35);
  std::vector<dynamics::WheelSpeedsUmS> on_wire;
  for (const wire::Step& step : host.all<wire::Step>()) {
    if (step.slot == 0) on_wire.push_back({step.left_um_s, step.right_um_s});
  }
  ASSERT_GE(on_wire.size(), 300U);
  for (std::size_t i = 0; i < 300; ++i) {
    EXPECT_EQ(on_wire[i].left, on_bus[i].left) << i;
    EXPECT_EQ(on_wire[i].right, on_bus[i].right) << i;
  }
}

TEST(WireRobots, ChangeTheirMotorsAtTimesOfTheirOwnClock) {
  WorldSettings settings;
  settings.arena = {20, 20};
  settings.clock_error = 0.01;
  Bench bench(settings, wireRobotAt(10, 10, 0));
  WireHost host(bench.ports, "robot_07");
  bench.run(1.1);
  bench.configure(host, abpProgram(0.03, 0.1, 3), 5);
  host.run(60'000);
  // The true turning rate changes with each draw: every 100 ms of the robot's clock.
  std::vector<std::int64_t> changes;
  double turn = 0;
  double theta = bench.world.pose(0).theta;
  while (changes.size() < 200) {
    bench.run(0.002);
    const double now = bench.world.pose(0).theta;
    if (std::abs(now - theta - turn) > 1e-9) changes.push_back(bench.world.timeUs());
    turn = now - theta;
    theta = now;
  }
  // A change inside a slice is visible in two slices.
  const double rate = bench.world.clock(0).rate();
  ASSERT_NE(rate, 1);
  const double elapsed = static_cast<double>(changes.back() - changes[0]);
  const double holds = elapsed * rate / 100'000;
  EXPECT_NEAR(holds, std::round(holds), 0.05);
}

TEST(WireRobots, SwitchProgramsByTheLightAndReverseFromARobotAhead) {
  Bench bench(idealHardware(), wireRobotAt(0.6, 0.45, 0));
  const Program program = wheelsProgram(0.05, 0.05);
  dynamics::CoreSettings settings = always(program);
  settings.reversal.distance_um = 50000;
  bench.world.moveKinematicDisk(bench.world.addKinematicDisk(), {0.75, 0.45});
  WireHost host(bench.ports, "robot_07");
  host.load(program);
  bench.run(1);
  host.configure(settings, 1);
  host.run(60'000);
  bench.run(5);
  ASSERT_FALSE(host.all<wire::State>().empty());
  EXPECT_GT(host.all<wire::State>().back().reversal_count, 0);
  EXPECT_EQ(bench.world.state(0).robot_contacts, 0);
}

TEST(WireRobots, AResetKeepsOnlyTheStoredSettings) {
  Bench bench;
  WireHost host(bench.ports, "robot_07");
  bench.configure(host, wheelsProgram(0.02, 0.02), 1);
  host.run(60'000);
  bench.run(1);
  const double x = bench.world.pose(0).x;
  EXPECT_GT(x, 0.6);
  bench.robots->robot(0).reset(bench.world.timeUs());
  bench.run(2);
  EXPECT_NEAR(bench.world.pose(0).x, x, 0.02 * 0.003)
      << "it stops at once and does not start again";
  const auto hellos = host.all<wire::Hello>();
  ASSERT_GE(hellos.size(), 2U);
  EXPECT_EQ(hellos.back().uid, kUid);
  EXPECT_EQ(hellos.back().reset_cause, wire::kResetPin);
  EXPECT_NE(hellos.back().boot_id, hellos.front().boot_id);
}

TEST(WireRobots, TwoRunsAreIdenticalToTheByte) {
  const auto run = [] {
    WorldSettings settings;
    std::vector<RobotSetup> setups = robots(5);
    for (RobotSetup& setup : setups) setup.external = true;
    Bench bench(settings, setups);
    std::vector<std::unique_ptr<WireHost>> hosts;
    for (const std::string& name : bench.ports.offered()) {
      hosts.push_back(std::make_unique<WireHost>(bench.ports, name));
    }
    bench.run(1.1);
    for (const auto& host : hosts) {
      bench.configure(*host, abpProgram(0.05), 3);
      host->run(60'000);
    }
    bench.run(20);
    std::vector<std::uint8_t> bytes;
    for (const auto& host : hosts) {
      bytes.insert(bytes.end(), host->bytes.begin(), host->bytes.end());
    }
    bytes.push_back(static_cast<std::uint8_t>(bench.world.collisions()));
    return bytes;
  };
  const std::vector<std::uint8_t> first = run();
  EXPECT_GT(first.size(), 50000U);
  EXPECT_EQ(first, run());
}

}  // namespace
}  // namespace lab::sim
