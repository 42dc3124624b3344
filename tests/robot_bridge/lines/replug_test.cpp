// Robots that are unplugged and plugged in again, on pseudo terminals, in real time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/loop/asio_loop.hpp"
#include "common/serial/serial_devices.hpp"
#include "robot_bridge/lines/port_manager.hpp"
#include "tests/support/loop_until.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/wire_robot.hpp"

namespace lab::bridge {
namespace {

constexpr std::int32_t kRobots = 10;
constexpr int kRounds = 20;

class ReplugTest : public testing::Test {
 protected:
  ReplugTest() {
    for (std::int32_t id = 1; id <= kRobots; ++id) {
      LinkSettings settings;
      settings.id = id;
      links.emplace_back(settings);
      by_uid[uidOf(id)] = &links.back();
      WireRobotOptions options;
      options.uid = uidOf(id);
      robots.emplace_back(loop, ports, options);
    }
    dut = std::make_unique<PortManager>(loop, ports, PortSettings{true, "", 38400}, by_uid,
                                        [this](const std::string& text) { notes.push_back(text); });
    loop.every(20'000, loop.now(), [this] { dut->tick(); });
    loop.every(100'000, loop.now(), [this] { command(); });
  }

  static std::uint32_t uidOf(std::int32_t id) { return 1000U + static_cast<std::uint32_t>(id); }
  static std::string nameOf(std::int32_t place) { return "usb" + std::to_string(place); }

  void command() {
    robot_order_t order{};
    order.mode = robot_order_t::DRIVE;
    order.wheel_left = order.wheel_right = 0.1;
    for (RobotLink& link : links) link.command(1, 1, 300, order, loop.now());
    dut->flush();
  }

  static std::ptrdiff_t openDescriptors() {
    return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {});
  }

  TemporaryFolder folder;
  AsioLoop loop;
  SerialDevices ports{loop, folder / "ports"};
  std::deque<RobotLink> links;
  PortManager::Robots by_uid;
  std::deque<WireRobot> robots;
  std::unique_ptr<PortManager> dut;
  std::vector<std::string> notes;
};

TEST_F(ReplugTest, TwoHundredReplugsLeakNothing) {
  const std::ptrdiff_t before = openDescriptors();
  for (int round = 0; round < kRounds; ++round) {
    for (std::int32_t i = 0; i < kRobots; ++i) {
      robots[static_cast<std::size_t>(i)].plug(nameOf((i + round) % kRobots));
    }
    EXPECT_TRUE(
        loopUntil(loop,
                  [&] {
                    for (std::int32_t i = 0; i < kRobots; ++i) {
                      const auto n = static_cast<std::size_t>(i);
                      if (!dut->lineOf(links[n]).ends_with("/" + nameOf((i + round) % kRobots)))
                        return false;
                      if (robots[n].left() == 0) return false;  // it must have received the order
                    }
                    return true;
                  }))
        << "round " << round << ": a robot was not found, or on a wrong line";
    for (std::size_t i = 0; i < links.size(); ++i) {
      EXPECT_EQ(links[i].hello()->uid, uidOf(links[i].settings().id));
    }
    for (WireRobot& robot : robots) robot.unplug();
    EXPECT_TRUE(loopUntil(loop,
                          [&] {
                            return std::none_of(
                                links.begin(), links.end(),
                                [](const RobotLink& link) { return link.isPlugged(); });
                          }))
        << "round " << round << ": a line is blocked";
    // Wait for the lease to end, because otherwise a turning wheel does not prove a new order.
    EXPECT_TRUE(loopUntil(loop, [&] {
      return std::all_of(robots.begin(), robots.end(),
                         [](const WireRobot& robot) { return robot.left() == 0; });
    }));
  }
  EXPECT_EQ(openDescriptors(), before) << "descriptors leaked";
  EXPECT_EQ(notes.size(), static_cast<std::size_t>(kRobots * kRounds)) << "one report per loss";
}

}  // namespace
}  // namespace lab::bridge
