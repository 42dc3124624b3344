// Robots with different bodies in one arena, with the whole service.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <lab/experiment_event_t.hpp>
#include <lab/robot_calibration_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/sim_truth_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/log_file.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/experiment/service_placement.hpp"
#include "common/loop/virtual_loop.hpp"
#include "common/serial/memory_serial.hpp"
#include "sim_svc/sim_service.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/wire_host.hpp"

namespace lab::sim {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;
using testing::UnorderedElementsAre;

constexpr const char* kExperiment = R"(
fileversion = 1
name = "bodies"
duration_s = 10
program = "abp"
[robot]
clock_error_percent = 0
[[robots]]
id = 1
x_cm = 30
y_cm = 45
theta_deg = 0
[[robots]]
id = 2
body = "wire"
x_cm = 60
y_cm = 45
theta_deg = 0
[[robots]]
id = 3
body = "serial"
uid = 99
[[robots]]
id = 4
body = "replay"
log = "recorded.lcmlog"
recorded_id = 8
[programs.abp]
model = "abp"
v_cm_s = 3
epsilon_s = 0.5
eta_rad_s = 3
)";

std::vector<std::int32_t> idsOf(const auto& message) {
  std::vector<std::int32_t> ids;
  for (const auto& robot : message.robots) ids.push_back(robot.robot_id);
  return ids;
}

/// A recording of robot 8, which stands at (90, 20) cm for a second.
void record(const std::filesystem::path& path) {
  LogWriter log(path);
  const auto write = [&log](std::string_view channel, const auto& message) {
    const std::vector<std::uint8_t> bytes = encode(message);
    log.write({channel, bytes, message.utime});
  };
  for (std::int64_t utime = 7'000'000; utime <= 8'000'000; utime += 20'000) {
    tracked_frame_t frame{};
    frame.utime = utime;
    frame.frame_period = 0.02;
    tracked_pose_t pose{};
    pose.robot_id = 8;
    pose.x = 0.9;
    pose.y = 0.2;
    frame.robots = {pose};
    frame.num_robots = 1;
    write(channels::kTrackedFrame, frame);
    robot_status_t status{};
    status.utime = utime;
    robot_state_t state{};
    state.robot_id = 8;
    state.utime = utime;
    state.program.hash = 77;
    state.program.name = "bp";
    status.robots = {state};
    status.num_robots = 1;
    write(channels::kRobotStatus, status);
  }
  log.flush();
}

class BodiesTest : public testing::Test {
 protected:
  BodiesTest() {
    loop.drainWith([this] { bus.deliver(); });
    record(folder / "recorded.lcmlog");
    dut = std::make_unique<SimService>(
        ServiceContext{node, loop, experiment, folder / "", ports, folder / ""});
    other.subscribe<robot_status_t>(channels::kRobotStatus,
                                    [this](const auto& message) { statuses.push_back(message); });
    other.subscribe<tracked_frame_t>(channels::kTrackedFrame, [this](const auto& message) {
      if (message.sender == "sim_svc") frames.push_back(message);
    });
    other.subscribe<sim_truth_t>(channels::kSimTruth,
                                 [this](const auto& message) { truths.push_back(message); });
    other.subscribe<robot_calibration_t>(channels::kCalibrationStatus, [this](const auto& message) {
      calibrations.push_back(message);
    });
  }

  void run(double seconds) { loop.runUntil(loop.now() + static_cast<std::int64_t>(seconds * 1e6)); }

  /// Publishes a camera frame with the real robot 3.
  void seeReal(double x, double y) {
    tracked_frame_t frame{};
    frame.utime = loop.now();
    tracked_pose_t pose{};
    pose.robot_id = 3;
    pose.x = x;
    pose.y = y;
    frame.robots = {pose};
    frame.num_robots = 1;
    other.publish(channels::kTrackedFrame, frame);
    bus.deliver();
  }

  [[nodiscard]] const true_pose_t& truth(std::int32_t id) const {
    for (const true_pose_t& robot : truths.back().robots) {
      if (robot.robot_id == id) return robot;
    }
    throw std::runtime_error("no robot " + std::to_string(id));
  }

  TemporaryFolder folder;
  VirtualLoop loop;
  MemoryBus bus{[this] { return loop.now(); }};
  MemorySerial ports{loop};
  Experiment experiment = parseExperiment(kExperiment, "bodies");
  Node node{bus, loop, {"sim_svc", robot_state_t::SIM, 1}};
  Node other{bus, loop, {"test", 0, 1}};
  std::unique_ptr<SimService> dut;
  std::vector<robot_status_t> statuses;
  std::vector<tracked_frame_t> frames;
  std::vector<sim_truth_t> truths;
  std::vector<robot_calibration_t> calibrations;
};

TEST_F(BodiesTest, EachBodyUsesItsOwnChannels) {
  EXPECT_THAT(ports.offered(), ElementsAre("robot_02"));
  WireHost host(ports, "robot_02");
  run(0.9);
  EXPECT_THAT(idsOf(statuses.back()), ElementsAre(1, 4)) << "robot_bridge handles the wire robot";
  EXPECT_EQ(statuses.back().robots[1].origin, robot_state_t::REPLAY);
  EXPECT_EQ(statuses.back().robots[1].program.hash, 77);
  EXPECT_EQ(statuses.back().robots[1].program.name, "bp");
  EXPECT_THAT(idsOf(frames.back()), ElementsAre(1, 2, 4))
      << "the real camera tracks the real robot";
  EXPECT_THAT(idsOf(truths.back()), ElementsAre(1, 2, 4));
  EXPECT_EQ(truth(4).x, 0.9);
  EXPECT_EQ(truth(2).program, 0);
  ASSERT_FALSE(host.all<wire::Hello>().empty());
  EXPECT_EQ(host.all<wire::Hello>()[0].uid, simulatedUid(2));
}

TEST_F(BodiesTest, ARecordedRobotIsRemovedAtTheEndOfItsRecording) {
  run(1.2);
  EXPECT_THAT(idsOf(statuses.back()), ElementsAre(1));
  EXPECT_THAT(idsOf(frames.back()), ElementsAre(1, 2));
  EXPECT_THAT(idsOf(truths.back()), ElementsAre(1, 2));
}

TEST_F(BodiesTest, SimulatedRobotsAreMovedByARealOneAndSenseIt) {
  run(0.1);
  seeReal(0.26, 0.45);  // 4 cm behind robot 1
  run(0.2);
  EXPECT_NEAR(truth(1).x, 0.26 + 0.075, 1e-6);
  EXPECT_EQ(statuses.back().robots[0].ir[3], 1023) << "behind";
  seeReal(0.48, 0.45);  // 4.5 cm behind the wire robot's rim
  WireHost host(ports, "robot_02");
  host.send(wire::GetInfo());
  run(0.5);
  const auto telemetry = host.all<wire::Telemetry>();
  ASSERT_FALSE(telemetry.empty());
  EXPECT_GT(telemetry.back().sensors[2 + 3], 0);
}

TEST_F(BodiesTest, ARealRobotIsRemovedAfterTwoSecondsWithoutFrames) {
  run(0.1);
  seeReal(0.40, 0.45);  // 2.5 cm before robot 1's rim
  run(1.9);
  EXPECT_GT(statuses.back().robots[0].ir[0], 0);
  run(0.2);
  EXPECT_EQ(statuses.back().robots[0].ir[0], 0);
}

TEST_F(BodiesTest, BusRobotsStoreACalibrationAndReportIt) {
  run(0.1);
  robot_calibration_t calibration{};
  calibration.seq = 12;
  for (const std::int32_t id : {1, 2}) {
    motor_calibration_t motors{};
    motors.robot_id = id;
    motors.gain_left = 1.05;
    motors.gain_right = 0.95;
    motors.dead_band_left = 0.1;
    motors.dead_band_right = 0.2;
    motors.wheel_base = 0.076;
    calibration.robots.push_back(motors);
  }
  calibration.num_robots = 2;
  other.publishCommand(channels::kRobotCalibration, calibration);
  run(0.1);
  ASSERT_EQ(calibrations.size(), 1U);
  EXPECT_EQ(calibrations[0].seq, 12);
  ASSERT_THAT(idsOf(calibrations[0]), ElementsAre(1)) << "robot_bridge handles the wire robot";
  const motor_calibration_t& held = calibrations[0].robots[0];
  EXPECT_NEAR(held.gain_left, 1.05, 1e-6);
  EXPECT_NEAR(held.gain_right, 0.95, 1e-6);
  EXPECT_NEAR(held.dead_band_left, 0.1, 0.5 / 255);
  EXPECT_NEAR(held.dead_band_right, 0.2, 0.5 / 255);
  EXPECT_NEAR(held.wheel_base, 0.076, 1e-9);

  // A gain of 0 only reads the calibration.
  robot_calibration_t question{};
  question.seq = 13;
  question.robots.resize(1);
  question.robots[0].robot_id = 1;
  question.num_robots = 1;
  other.publishCommand(channels::kRobotCalibration, question);
  run(0.1);
  ASSERT_EQ(calibrations.size(), 2U);
  EXPECT_EQ(calibrations[1].seq, 13);
  EXPECT_EQ(calibrations[1].robots[0].gain_left, held.gain_left);
  EXPECT_EQ(calibrations[1].robots[0].wheel_base, held.wheel_base);
}

TEST_F(BodiesTest, MissingFilesPreventTheStart) {
  experiment.robots[1].body = Body::kFirmware;
  MemorySerial own_ports(loop);
  const ServiceContext context{node, loop, experiment, folder / "", own_ports, folder / ""};
  EXPECT_THAT([&] { SimService service(context); },
              ThrowsMessage<std::runtime_error>(HasSubstr("robot_emulator: not there")));
  EXPECT_THAT(own_ports.offered(), IsEmpty()) << "no line was created";
  experiment.robots[1].body = Body::kWire;
  experiment.robots[3].recorded_id = 9;
  EXPECT_THAT([&] { SimService service(context); },
              ThrowsMessage<std::runtime_error>(
                  HasSubstr("robot 4 is to replay " + (folder / "recorded.lcmlog").string() +
                            ": no camera frame has robot 9; it has 8")));
}

TEST(Bodies, TheServiceIsNotNeededWhenAllRobotsAreReal) {
  Experiment experiment = parseExperiment(kExperiment, "bodies");
  EXPECT_TRUE(isNeeded(experiment, "sim_svc"));
  for (RobotSpec& robot : experiment.robots) robot.body = Body::kSerial;
  EXPECT_FALSE(isNeeded(experiment, "sim_svc"));
}

}  // namespace
}  // namespace lab::sim
