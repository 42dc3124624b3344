/// The whole bridge in virtual time: lines in memory, robots that run the firmware, and another
/// node on the bus that sends commands and receives the results.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <deque>
#include <lab/robot_command_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/robot_steps_t.hpp>
#include <lab/robot_stop_t.hpp>
#include <lab/service_status_t.hpp>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/experiment/program_messages.hpp"
#include "common/loop/virtual_loop.hpp"
#include "common/programs/shipped_programs.hpp"
#include "common/serial/memory_serial.hpp"
#include "robot_bridge/bridge_service.hpp"
#include "tests/support/wire_robot.hpp"

namespace lab::bridge {

class BridgeFixture : public testing::Test {
 protected:
  /// @param count wire robots 1..count in the experiment
  explicit BridgeFixture(int count = 2) : experiment(makeExperiment(count)) {
    loop.drainWith([this] { bus.deliver(); });
    other.subscribe<robot_status_t>(channels::kRobotStatus, [this](const robot_status_t& status) {
      statuses.push_back(status);
      for (const robot_state_t& robot : status.robots) last[robot.robot_id] = robot;
    });
    other.subscribe<robot_steps_t>(channels::kRobotSteps, [this](const robot_steps_t& message) {
      steps.insert(steps.end(), message.steps.begin(), message.steps.end());
    });
    other.subscribe<service_status_t>(channels::kServiceStatus,
                                      [this](const service_status_t& status) {
                                        if (status.sender == "robot_bridge")
                                          errors.insert(status.last_error);
                                      });
  }

  static Experiment makeExperiment(int count) {
    std::string text = R"(
fileversion = 1
name = "wired"
duration_s = 10
program = "abp"
[programs.abp]
model = "abp"
v_cm_s = 3
epsilon_s = 0.5
eta_rad_s = 3
)";
    for (int id = 1; id <= count; ++id) {
      text += "[[robots]]\nid = " + std::to_string(id) + "\nbody = \"wire\"\n";
    }
    return parseExperiment(text, "wired");
  }

  void start() {
    dut = std::make_unique<BridgeService>(ServiceContext{node, loop, experiment, {}, ports});
    node.start();
  }

  WireRobot& addRobot(std::int32_t id, WireRobotOptions options = {}) {
    if (options.uid == 0) options.uid = simulatedUid(id);
    WireRobot& robot = robots.emplace_back(loop, ports, options);
    robot.plug("robot_" + std::to_string(id));
    return robot;
  }

  void run(double seconds) { loop.runUntil(loop.now() + static_cast<std::int64_t>(seconds * 1e6)); }

  /// Runs while the last command is repeated at 5 Hz, as the lab does.
  void runCommanded(double seconds) {
    for (double t = 0; t < seconds; t += 0.2) {
      repeatCommand();
      run(0.2);
    }
  }

  void command(const robot_order_t& order, std::int64_t seq) {
    commanded.seq = seq;
    commanded.lease_ms = 1000;
    commanded.orders = {order};
    commanded.num_orders = 1;
    repeatCommand();
  }
  void repeatCommand() {
    commanded.utime = loop.now();
    other.publishCommand(channels::kRobotCommand, commanded);
    bus.deliver();
  }
  void stop(std::int64_t seq, bool clear) {
    robot_stop_t message{};
    message.seq = seq;
    message.clear = clear ? 1 : 0;
    other.publishCommand(channels::kRobotStop, message);
    bus.deliver();
  }

  static robot_order_t drive(std::vector<std::int32_t> ids, double left, double right) {
    robot_order_t order{};
    order.mode = robot_order_t::DRIVE;
    order.num_robots = static_cast<std::int32_t>(ids.size());
    order.robot_ids = std::move(ids);
    order.wheel_left = left;
    order.wheel_right = right;
    return order;
  }

  /// ABP in light below half, RTP above.
  static robot_order_t table(std::vector<std::int32_t> ids) {
    robot_order_t order{};
    order.mode = robot_order_t::TABLE;
    order.num_robots = static_cast<std::int32_t>(ids.size());
    order.robot_ids = std::move(ids);
    order.hysteresis = 0.02;
    order.reverse_on = robot_order_t::REVERSE_ANY;
    order.reverse_distance = 0.4;
    order.reverse_speed = 0.1;
    light_band_t abp{};
    abp.high = 0.5;
    abp.program = toMessage(
        shippedProgram("abp", {{"v", "3 cm/s"}, {"epsilon", "0.5 s"}, {"eta", "3 rad/s"}}));
    light_band_t rtp{};
    rtp.low = 0.5;
    rtp.high = 1;
    rtp.program =
        toMessage(shippedProgram("rtp", {{"v", "5 cm/s"}, {"gamma", "3 1/s"}, {"tau_t", "0.5 s"}}));
    order.bands = {abp, rtp};
    order.num_bands = 2;
    return order;
  }

  VirtualLoop loop;
  MemoryBus bus{[this] { return loop.now(); }};
  MemorySerial ports{loop};
  Experiment experiment;
  Node node{bus, loop, {"robot_bridge", robot_state_t::UNKNOWN, 1}};
  Node other{bus, loop, {"test", 0, 1}};
  std::unique_ptr<BridgeService> dut;
  std::deque<WireRobot> robots;
  robot_command_t commanded{};
  std::vector<robot_status_t> statuses;
  std::map<std::int32_t, robot_state_t> last;
  std::vector<robot_step_t> steps;
  std::set<std::string> errors;
};

}  // namespace lab::bridge
