// Robots on simulated chips: the firmware binary in lockstep with the world.
#include "sim_svc/bodies/chip_robots.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <fstream>
#include <optional>
#include <stdexcept>

#include "common/loop/virtual_loop.hpp"
#include "common/math/random.hpp"
#include "common/serial/memory_serial.hpp"
#include "robot/firmware/settings.hpp"
#include "sim_svc/bodies/external_robots.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/wire_host.hpp"
#include "tests/support/world_fixture.hpp"

namespace lab::sim::chip_robots_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;
namespace fs = std::filesystem;

fs::path programs() { return fs::canonical("/proc/self/exe").parent_path(); }

std::vector<RobotSetup> chipAt(double x, double y, double theta) {
  return {{7, dynamics::Pose{x, y, theta}, true}};
}

std::vector<ChipRobotSetup> chips(const World& world) {
  std::vector<ChipRobotSetup> setups;
  for (std::size_t i = 0; i < world.size(); ++i) {
    firmware::Settings settings;
    settings.uid = 0x51000000U + static_cast<std::uint32_t>(world.id(i));
    std::vector<std::uint8_t> eeprom(firmware::kStoreSize);
    firmware::encodeStore(settings, eeprom.data());
    setups.push_back({i, std::move(eeprom)});
  }
  return setups;
}

/// A world with robots on chips that follows virtual time, as in the service.
struct Bench {
  explicit Bench(const WorldSettings& settings = idealHardware(),
                 const std::vector<RobotSetup>& setups = chipAt(0.6, 0.45, 0))
      : world(settings, setups) {
    world.setLight(&light);
    auto driver =
        std::make_unique<ChipRobots>(world, chips(world), programs(),
                                     [this](const std::string& what) { reports.push_back(what); });
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
  ChipRobots* robots = nullptr;
  std::vector<std::string> reports;
};

class ChipRobotsTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!LAB_TEST_HAS_EMULATOR) {
      GTEST_SKIP() << "robot_emulator is not built: LAB_EMULATOR is off, or libsimavr or avr-gcc "
                      "is not installed";
    }
  }
};

TEST_F(ChipRobotsTest, SendHelloWithTheirUid) {
  Bench bench;
  EXPECT_EQ(bench.ports.offered(), std::vector<std::string>{"robot_07"});
  WireHost host(bench.ports, "robot_07");
  bench.run(1.5);
  ASSERT_FALSE(host.all<wire::Hello>().empty());
  EXPECT_EQ(host.all<wire::Hello>()[0].uid, 0x51000007U);
  EXPECT_EQ(host.all<wire::Hello>()[0].board, 1);
  EXPECT_THAT(bench.reports, testing::IsEmpty());
}

TEST_F(ChipRobotsTest, DriveAtTheOrderedSpeed) {
  Bench bench(idealHardware(), chipAt(0.3, 0.45, 0));
  WireHost host(bench.ports, "robot_07");
  bench.run(0.2);
  bench.configure(host, abpProgram(), 1);
  bench.run(0.3);
  const dynamics::Pose before = bench.world.pose(0);
  host.order.mode = wire::Order::kDrive;
  host.order.left_um_s = 90000;  // a third of the full speed: exactly duty 85
  host.order.right_um_s = 90000;
  host.order.lease_ms = 1000;
  host.send(host.order);
  bench.run(3);
  EXPECT_NEAR(bench.world.pose(0).x - before.x, 0.09, 0.09 * 0.003);
  EXPECT_NEAR(bench.world.pose(0).y, before.y, 1e-4);
}

TEST_F(ChipRobotsTest, DrawTheSameAsABusRobotWithTheSameSeed) {
  constexpr std::uint64_t kSeed = 11;
  const Program program = abpProgram(0.03, 0.1, 3);
  WorldSettings settings;
  settings.seed = kSeed;
  settings.arena = {20, 20};

  std::vector<RobotSetup> setups = chipAt(10, 10, 0);
  setups[0].external = false;
  World bus(settings, setups);
  const StepLight light(0.6, 0.5, 0.5);
  bus.setLight(&light);
  startAll(bus, always(program));
  std::vector<dynamics::WheelSpeedsUmS> on_bus;
  std::uint32_t draws = 0;
  while (on_bus.size() < 100) {
    bus.step(1000);
    const dynamics::CoreReport report = bus.core(0).report();
    if (report.program == program.hash && report.draw_count != draws) on_bus.push_back(report.held);
    draws = report.draw_count;
  }

  Bench bench(settings, chipAt(10, 10, 0));
  WireHost host(bench.ports, "robot_07");
  bench.run(1.2);
  bench.configure(host, program, deriveSeed(kSeed, 7, "program"));
  host.run(60'000);
  bench.run(12);
  std::vector<dynamics::WheelSpeedsUmS> on_chip;
  for (const wire::Step& step : host.all<wire::Step>()) {
    if (step.slot == 0) on_chip.push_back({step.left_um_s, step.right_um_s});
  }
  ASSERT_GE(on_chip.size(), 100U);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_EQ(on_chip[i].left, on_bus[i].left) << i;
    EXPECT_EQ(on_chip[i].right, on_bus[i].right) << i;
  }
}

TEST_F(ChipRobotsTest, TwoRunsAreIdenticalToTheByte) {
  const auto run = [] {
    std::vector<RobotSetup> setups = {{7, std::nullopt, true}, {8, std::nullopt, true}};
    Bench bench(WorldSettings(), setups);
    WireHost host(bench.ports, "robot_07");
    WireHost other(bench.ports, "robot_08");
    bench.run(1.2);
    bench.configure(host, abpProgram(0.05), 3);
    host.run(60'000);
    bench.run(8);
    std::vector<std::uint8_t> bytes = host.bytes;
    bytes.insert(bytes.end(), other.bytes.begin(), other.bytes.end());
    return bytes;
  };
  const std::vector<std::uint8_t> first = run();
  EXPECT_GT(first.size(), 5000U);
  EXPECT_EQ(first, run());
}

TEST_F(ChipRobotsTest, StandAndAreSwitchedOnAgainWhenTheEmulatorEnds) {
  Bench bench(idealHardware(), chipAt(0.3, 0.45, 0));
  WireHost host(bench.ports, "robot_07");
  bench.run(0.2);
  bench.configure(host, wheelsProgram(0.05, 0.05), 1);
  host.run(60'000);
  bench.run(1);
  const double x = bench.world.pose(0).x;
  EXPECT_GT(x, 0.3);
  kill(bench.robots->emulator()->pid(), SIGKILL);
  bench.run(0.9);
  ASSERT_EQ(bench.reports.size(), 1U);
  EXPECT_THAT(bench.reports[0],
              AllOf(HasSubstr("robot_emulator: ended by signal 9"), HasSubstr("stand")));
  EXPECT_NEAR(bench.world.pose(0).x, x, 1e-4);
  const std::size_t hellos = host.all<wire::Hello>().size();
  bench.run(0.5);
  ASSERT_EQ(host.all<wire::Hello>().size(), hellos + 1);
  EXPECT_EQ(host.all<wire::Hello>().back().reset_cause, wire::kResetPower);
  EXPECT_NEAR(bench.world.pose(0).x, x, 1e-4) << "it stands until a new order";
  EXPECT_EQ(bench.reports.size(), 1U);
}

TEST_F(ChipRobotsTest, AHangingEmulatorIsReplacedUpToThreeTimes) {
  Bench bench;
  bench.run(0.2);
  kill(bench.robots->emulator()->pid(), SIGSTOP);
  bench.run(1.5);  // 2 s of real time
  ASSERT_EQ(bench.reports.size(), 1U);
  EXPECT_THAT(bench.reports[0], HasSubstr("no answer within 2 s"));
  for (int failure = 2; failure <= 3; ++failure) {
    ASSERT_NE(bench.robots->emulator(), nullptr);
    kill(bench.robots->emulator()->pid(), SIGKILL);
    bench.run(1.5);
  }
  ASSERT_EQ(bench.reports.size(), 3U);
  EXPECT_THAT(bench.reports[2], HasSubstr("stay off"));
  bench.run(5);
  EXPECT_EQ(bench.robots->emulator(), nullptr);
  EXPECT_EQ(bench.reports.size(), 3U);
}

TEST_F(ChipRobotsTest, TheEmulatorEndsWithItsOwner) {
  pid_t pid = 0;
  {
    Bench bench;
    pid = bench.robots->emulator()->pid();
    EXPECT_EQ(kill(pid, 0), 0);
  }
  EXPECT_EQ(kill(pid, 0), -1);
}

/// Starts robots with these programs in a world of their own.
void startWith(const fs::path& folder) {
  const World world(idealHardware(), chipAt(0.6, 0.45, 0));
  const ChipRobots dut(world, chips(world), folder, [](const std::string&) {});
}

void makeProgram(const fs::path& path, const std::string& script) {
  std::ofstream(path) << "#!/bin/sh\n" << script << '\n';
  fs::permissions(path, fs::perms::owner_all);
}

TEST(ChipRobotsStart, NamesAMissingProgramWithASolution) {
  TemporaryFolder folder;
  EXPECT_THAT([&] { startWith(folder / ""); },
              ThrowsMessage<std::runtime_error>(AllOf(HasSubstr("robot 7"),
                                                      HasSubstr("robot_emulator: not there"),
                                                      HasSubstr("libsimavr-dev"))));
  makeProgram(folder / "robot_emulator", "exit 0");
  EXPECT_THAT([&] { startWith(folder / ""); },
              ThrowsMessage<std::runtime_error>(
                  AllOf(HasSubstr("robot_firmware.elf: not there"), HasSubstr("gcc-avr"))));
}

TEST(ChipRobotsStart, ReportsWhyTheEmulatorDoesNotStart) {
  TemporaryFolder folder;
  std::ofstream(folder / "robot_firmware.elf") << "no program";
  makeProgram(folder / "robot_emulator", "exit 3");
  EXPECT_THAT([&] { startWith(folder / ""); },
              ThrowsMessage<std::runtime_error>(
                  HasSubstr("robot_emulator does not start: ended with code 3")));
}

TEST_F(ChipRobotsTest, ReportsTheEmulatorsReasonForAnInvalidFirmware) {
  TemporaryFolder folder;
  std::ofstream(folder / "robot_firmware.elf") << "no program";
  // The emulator expects the firmware in its own folder.
  fs::copy_file(programs() / "robot_emulator", folder / "robot_emulator");
  EXPECT_THAT([&] { startWith(folder / ""); },
              ThrowsMessage<std::runtime_error>(
                  AllOf(HasSubstr("does not start"), HasSubstr("robot_firmware.elf"))));
}

}  // namespace
}  // namespace lab::sim::chip_robots_test
