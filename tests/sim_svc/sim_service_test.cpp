#include "sim_svc/sim_service.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <lab/light_status_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/service_status_t.hpp>
#include <lab/sim_truth_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/experiment/experiment_messages.hpp"
#include "common/experiment/program_messages.hpp"
#include "common/loop/virtual_loop.hpp"
#include "common/programs/program_library.hpp"
#include "tests/support/programs.hpp"

namespace lab::sim::sim_service_test {
namespace {

constexpr std::int64_t kSecond_us = 1'000'000;

/// The service on an in-memory bus, with another node that commands and receives.
class SimServiceTest : public testing::Test {
 protected:
  SimServiceTest() {
    loop.drainWith([this] { bus.deliver(); });
    other.subscribe<robot_status_t>(channels::kRobotStatus, [this](const robot_status_t& status) {
      statuses.push_back(status);
    });
    other.subscribe<tracked_frame_t>(channels::kTrackedFrame, [this](const tracked_frame_t& frame) {
      frames.push_back(frame);
      frame_arrivals.push_back(loop.now());
    });
    other.subscribe<service_status_t>(
        channels::kServiceStatus, [this](const service_status_t& status) { heartbeat = status; });
  }

  void command(const robot_order_t& order, std::int64_t seq, std::int32_t lease_ms = 1000) {
    robot_command_t message{};
    message.seq = seq;
    message.lease_ms = lease_ms;
    message.orders = {order};
    message.num_orders = 1;
    other.publishCommand(channels::kRobotCommand, message);
    bus.deliver();
  }

  /// Lets both robots run ABP in light from 0.4.
  void runInBrightLight() {
    robot_order_t order = lightTableCommand(experiment).orders.at(0);
    order.bands.resize(1);
    order.num_bands = 1;
    order.bands[0].low = 0.4;
    order.bands[0].high = 1;
    command(order, 1, 60'000);
    run(0.1);
  }

  void announce(std::int64_t utime, double intensity) {
    light_status_t status{};
    status.utime = utime;
    status.mix = 1;
    light_layer_t uniform{};
    uniform.kind = light_layer_t::UNIFORM;
    uniform.intensity = intensity;
    status.layers = {uniform};
    status.num_layers = 1;
    other.publish(channels::kLightStatus, status);
    bus.deliver();
  }

  [[nodiscard]] std::string lastError() {
    node.ready();  // a heartbeat
    bus.deliver();
    return heartbeat.last_error;
  }

  /// Whether a robot has run a program since the start.
  [[nodiscard]] bool anyRan() const {
    return std::ranges::any_of(statuses, [](const robot_status_t& status) {
      return std::ranges::any_of(
          status.robots, [](const robot_state_t& robot) { return robot.program.hash != 0; });
    });
  }

  void run(double seconds) { loop.runUntil(loop.now() + static_cast<std::int64_t>(seconds * 1e6)); }

  [[nodiscard]] const robot_state_t& last(std::size_t robot = 0) const {
    return statuses.back().robots.at(robot);
  }

  static robot_order_t drive(double left, double right) {
    robot_order_t order{};
    order.mode = robot_order_t::DRIVE;
    order.robot_ids = {1};
    order.num_robots = 1;
    order.wheel_left = left;
    order.wheel_right = right;
    return order;
  }

  VirtualLoop loop;
  MemoryBus bus{[this] { return loop.now(); }};
  Experiment experiment = parseExperiment(R"(
fileversion = 1
name = "two"
duration_s = 10
program = "abp"
[robot]
pwm_steps = false
clock_error_percent = 0
[[robots]]
id = 1
x_cm = 30
y_cm = 45
theta_deg = 0
[[robots]]
id = 2
x_cm = 90
y_cm = 45
theta_deg = 0
[programs.abp]
model = "abp"
v_cm_s = 3
epsilon_s = 0.5
eta_rad_s = 3
[camera]
delay_ms = 30
)",
                                          "two");
  Node node{bus, loop, {"sim_svc", robot_state_t::SIM, 1}};
  Node other{bus, loop, {"test", 0, 1}};
  SimService dut{{node, loop, experiment, {}}};
  std::vector<robot_status_t> statuses;
  std::vector<tracked_frame_t> frames;
  std::vector<std::int64_t> frame_arrivals;
  service_status_t heartbeat{};
};

TEST_F(SimServiceTest, PublishesAtExactMultiplesOfItsPeriodsAndDelaysTheTracker) {
  const std::int64_t start = loop.now();
  run(1);
  ASSERT_EQ(statuses.size(), 51U);
  EXPECT_EQ(statuses[50].robots.at(0).utime, start + kSecond_us);
  ASSERT_GE(frames.size(), 49U);
  EXPECT_EQ(frames[10].utime, start + 200'000);
  EXPECT_EQ(frame_arrivals[10], start + 230'000);
  EXPECT_EQ(frames[10].robots.size(), 2U);
}

TEST_F(SimServiceTest, RobotsStandUntilTheyAreCommanded) {
  run(2);
  EXPECT_EQ(last().program.hash, 0);
  EXPECT_EQ(last().program.name, "");
  EXPECT_EQ(frames.front().robots[0].x, frames.back().robots[0].x);
}

TEST_F(SimServiceTest, DrivesAtTheOrderedSpeedAndEchoesTheOrder) {
  command(drive(0.1, 0.1), 5);
  const std::size_t before = frames.size();
  run(0.5);
  EXPECT_EQ(last().command_seq, 5);
  EXPECT_EQ(last().program.hash, 0);
  EXPECT_EQ(last().program.name, "driven");
  // Frames of the last 30 ms are still delayed.
  const tracked_frame_t& frame = frames.back();
  const double driven_s = static_cast<double>(frame.utime - frames.at(before).utime) * 1e-6;
  EXPECT_NEAR(frame.robots[0].x - frames.at(before).robots[0].x, 0.1 * driven_s, 1e-9);
  EXPECT_EQ(last(1).command_seq, 0) << "the command is not for this robot";
}

TEST_F(SimServiceTest, AnOrderBeyondTheWheelLimitIsRefusedAndReported) {
  command(drive(1, 1), 6);
  run(0.1);
  EXPECT_NE(last().flags & robot_state_t::FLAG_REJECTED, 0);
  EXPECT_EQ(last().wheel_left, 0);
}

TEST_F(SimServiceTest, AnOrderWithByteCodeThatIsNoneIsRefusedAndReported) {
  robot_order_t order = lightTableCommand(experiment).orders.at(0);
  order.bands[0].program.code[0] ^= 0xFF;
  command(order, 6);
  run(0.1);
  EXPECT_NE(last().flags & robot_state_t::FLAG_REJECTED, 0);
  EXPECT_EQ(last().program.hash, 0);
}

TEST_F(SimServiceTest, AnOrderWhoseNameWouldFillEveryReportIsRefusedAndReported) {
  robot_order_t order = lightTableCommand(experiment).orders.at(0);
  order.bands[0].program.id.name = std::string(300'000, 'x');
  command(order, 6);
  run(0.1);
  EXPECT_EQ(last().command_seq, 6);
  EXPECT_NE(last().flags & robot_state_t::FLAG_REJECTED, 0);
  EXPECT_EQ(last().program.name, "");
  // Nor does it come with a program that stands.
  order.bands[0].program = {};
  order.bands[0].program.id.name = std::string(300'000, 'x');
  command(order, 7);
  run(0.1);
  EXPECT_EQ(last().command_seq, 7);
  EXPECT_NE(last().flags & robot_state_t::FLAG_REJECTED, 0);
  EXPECT_EQ(last().program.name, "");
}

TEST_F(SimServiceTest, ReportsThePhaseOfARobotAndItsTumbles) {
  const Program program = test::rtp(0.02, 3, 1);
  robot_order_t order = lightTableCommand(experiment).orders.at(0);
  order.bands[0].program = toMessage(program);
  for (int i = 0; i < 20; ++i) {
    command(order, 1);
    run(0.5);
  }
  int tumbling = 0;
  for (const robot_status_t& status : statuses) {
    for (const robot_state_t& robot : status.robots) {
      const bool second = robot.phase == 1;
      EXPECT_EQ((robot.flags & robot_state_t::FLAG_TUMBLING) != 0, second);
      if (!second) continue;
      ++tumbling;
      EXPECT_EQ(robot.program_left, -robot.program_right) << "a tumble is on the spot";
      EXPECT_EQ(robot.program.hash, program.hash);
    }
  }
  EXPECT_GT(tumbling, 0);
  EXPECT_GT(last().tumble_count, 0);
  EXPECT_LT(last().run_time, 10 - last().tumble_count + 1);
}

TEST_F(SimServiceTest, AnOrderWithMoreProgramsThanItCanKeepIsRefusedAndReported) {
  robot_order_t order = lightTableCommand(experiment).orders.at(0);
  for (std::size_t i = 0; i <= ProgramLibrary::kMost; ++i) {
    const double speed = 1e-5 * static_cast<double>(i + 1);
    order.bands[0].program = toMessage(test::wheels(speed, speed));
    command(order, static_cast<std::int64_t>(i + 1));
  }
  run(0.1);
  EXPECT_NE(last().flags & robot_state_t::FLAG_REJECTED, 0);
  EXPECT_NEAR(last().wheel_left, 1e-5 * ProgramLibrary::kMost, 1e-5)
      << "it keeps the program before";
}

TEST_F(SimServiceTest, StopsWhenTheHostIsSilentForItsLease) {
  command(drive(0.1, 0.1), 1);
  run(0.98);
  EXPECT_NE(last().wheel_left, 0);
  run(0.1);
  EXPECT_EQ(last().wheel_left, 0);
  EXPECT_NE(last().flags & robot_state_t::FLAG_LEASE_EXPIRED, 0);
}

TEST_F(SimServiceTest, AStopTakesPrecedenceOverCommandsUntilItIsReleased) {
  command(drive(0.1, 0.1), 1);
  robot_stop_t stop{};
  stop.seq = 77;
  other.publishCommand(channels::kRobotStop, stop);
  command(drive(0.2, 0.2), 2);
  run(0.1);
  EXPECT_EQ(last().wheel_left, 0);
  EXPECT_EQ(last().stop_seq, 77);
  EXPECT_NE(last().flags & robot_state_t::FLAG_STOPPED, 0);
  stop.seq = 78;
  stop.clear = 1;
  other.publishCommand(channels::kRobotStop, stop);
  run(0.1);
  EXPECT_NE(last().wheel_left, 0);
}

TEST_F(SimServiceTest, TheProjectedLightSelectsTheProgramWithinASensorPeriod) {
  command(lightTableCommand(experiment).orders.at(0), 1);
  run(0.1);
  light_status_t status{};
  status.mix = 1;
  light_layer_t uniform{};
  uniform.kind = light_layer_t::UNIFORM;
  uniform.intensity = 0.5;
  status.layers = {uniform};
  status.num_layers = 1;
  const std::int64_t shown = loop.now();
  other.publish(channels::kLightStatus, status);
  run(0.1);
  for (const robot_state_t& robot : statuses.back().robots) {
    EXPECT_EQ(robot.program.hash, experiment.programs.at("abp").hash);
    EXPECT_EQ(robot.program.name, "abp");
    EXPECT_EQ(robot.phase, 0);
    EXPECT_LE(robot.program_start_utime - shown, 20'000);
    EXPECT_NEAR((robot.program_left + robot.program_right) / 2, 0.03, 1e-9);
  }
}

TEST_F(SimServiceTest, AnnouncedLightIsSwitchedAtItsTime) {
  runInBrightLight();
  // Three frames are announced at once, as with a projector whose latency exceeds its frame period.
  const std::int64_t now = loop.now();
  announce(now + 40'000, 0.2);
  announce(now + 90'000, 0.5);
  announce(now + 140'000, 0.1);
  run(0.2);
  for (const robot_state_t& robot : statuses.back().robots) {
    EXPECT_EQ(robot.program.hash, 0) << "dark again";
  }
  std::int64_t first = 0;
  std::int64_t last = 0;
  for (const robot_status_t& status : statuses) {
    for (const robot_state_t& robot : status.robots) {
      if (robot.program.name != "abp") continue;
      if (first == 0) first = robot.program_start_utime;
      last = robot.utime;
    }
  }
  EXPECT_GE(first, now + 90'000);
  EXPECT_LE(first, now + 90'000 + 20'500);
  EXPECT_LE(last, now + 140'000 + 20'500);
}

TEST_F(SimServiceTest, LightOfTheFarFutureIsRefusedAndReported) {
  runInBrightLight();
  const std::int64_t now = loop.now();
  announce(now + 2'100'000, 0.5);
  run(3);
  EXPECT_FALSE(anyRan());
  EXPECT_EQ(lastError(),
            "LIGHT_STATUS of test is dated more than 2 s ahead; set the clocks: such light is "
            "ignored");
  announce(loop.now() + 1'900'000, 0.5);
  run(1.8);
  EXPECT_FALSE(anyRan());
  run(0.2);
  EXPECT_TRUE(anyRan()) << "light within the limit is shown as before";
}

TEST_F(SimServiceTest, KeepsAFixedNumberOfAnnouncements) {
  runInBrightLight();
  const std::int64_t first = loop.now() + 1'000'000;
  for (int i = 0; i < 10'000; ++i) {
    announce(first + i, i < 600 ? 0.2 : 0.5);
  }
  run(1.5);
  EXPECT_FALSE(anyRan()) << "the light from the 600th on is not shown";
  EXPECT_EQ(lastError(),
            "LIGHT_STATUS of test follows 512 that are announced; end the programs that do not "
            "belong to this lab: such light is ignored");
  announce(loop.now() + 10'000, 0.5);
  run(0.2);
  EXPECT_TRUE(anyRan()) << "there is room again";
}

}  // namespace
}  // namespace lab::sim::sim_service_test
