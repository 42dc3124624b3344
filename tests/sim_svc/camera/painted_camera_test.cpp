// The camera of sim_svc: pictures instead of poses.
#include "sim_svc/camera/painted_camera.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <lab/light_status_t.hpp>
#include <lab/robot_command_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <memory>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/camera/memory_cameras.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/experiment/light_messages.hpp"
#include "common/loop/virtual_loop.hpp"
#include "light/optics/simulated_camera.hpp"
#include "sim_svc/sim_service.hpp"

namespace lab::sim {
namespace {

struct Taken {
  std::int64_t number = 0;
  std::int64_t utime = 0;
  std::int64_t arrival = 0;
  std::vector<std::uint8_t> grey;
};

/// A lab with one robot and a camera with 320 x 240 pixels.
class PaintedLab {
 public:
  explicit PaintedLab(double frame_loss = 0) {
    loop.drainWith([this] { bus.deliver(); });
    experiment.camera.tracker = Tracker::kCamera;
    experiment.camera.width = 320;
    experiment.camera.height = 240;
    experiment.camera.frame_loss = frame_loss;
    other.subscribe<tracked_frame_t>(channels::kTrackedFrame,
                                     [this](const tracked_frame_t&) { ++tracked; });
    service = std::make_unique<SimService>(
        ServiceContext{node, loop, experiment, {}, noSerialPorts(), {}, cameras});
  }

  void watch() {
    CameraHandlers handlers;
    handlers.frame = [this](const CameraFrame& frame) {
      Taken taken{frame.number, frame.utime, loop.now(), {}};
      for (int y = 0; y < frame.grey.height; ++y) {
        const std::uint8_t* row = frame.grey.row(y);
        taken.grey.insert(taken.grey.end(), row, row + frame.grey.width);
      }
      frames.push_back(std::move(taken));
    };
    source = cameras.open("sim", {}, handlers);
  }

  void light(double intensity) {
    light_status_t status{};
    status.mix = 1;
    light::Layer layer;
    layer.intensity = intensity;
    status.layers = toMessages({layer});
    status.num_layers = 1;
    other.publish(channels::kLightStatus, status);
    bus.deliver();
  }

  void drive(double speed) {
    robot_command_t message{};
    message.seq = 1;
    message.lease_ms = 10'000;
    robot_order_t order{};
    order.mode = robot_order_t::DRIVE;
    order.robot_ids = {1};
    order.num_robots = 1;
    order.wheel_left = speed;
    order.wheel_right = speed;
    message.orders = {order};
    message.num_orders = 1;
    other.publishCommand(channels::kRobotCommand, message);
    bus.deliver();
  }

  void run(double seconds) { loop.runUntil(loop.now() + static_cast<std::int64_t>(seconds * 1e6)); }

  VirtualLoop loop;
  MemoryBus bus{[this] { return loop.now(); }};
  MemoryCameras cameras{loop};
  Experiment experiment = parseExperiment(R"(
fileversion = 1
name = "one"
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
[programs.abp]
model = "abp"
v_cm_s = 3
epsilon_s = 0.5
eta_rad_s = 3
[camera]
fps = 50
delay_ms = 30
)",
                                          "one");
  Node node{bus, loop, {"sim_svc", robot_state_t::SIM, 1}};
  Node other{bus, loop, {"test", 0, 1}};
  std::unique_ptr<SimService> service;
  std::unique_ptr<FrameSource> source;
  std::vector<Taken> frames;
  int tracked = 0;
};

/// Brightest and darkest pixel of the cap at (x, y) in a picture of 320 columns.
double meanAround(const Taken& taken, double x, double y) {
  const optics::CameraModel model(optics::simulatedCamera(320, 240, 1.20, 0.90));
  const optics::Pixel at = model.project(x, y, 0.05);
  double sum = 0;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      sum += taken.grey[static_cast<std::size_t>(std::lround(at.y) + dy) * 320 +
                        static_cast<std::size_t>(std::lround(at.x) + dx)];
    }
  }
  return sum / 9;
}

TEST(PaintedCamera, ExposesFramesAtExactTimesAndPublishesNoPoses) {
  PaintedLab lab;
  lab.watch();
  const std::int64_t start = lab.loop.now();
  lab.run(1);
  ASSERT_GE(lab.frames.size(), 48U);
  EXPECT_EQ(lab.tracked, 0);
  EXPECT_EQ(lab.frames[10].utime, start + 200'000);
  EXPECT_EQ(lab.frames[10].arrival, start + 230'000);
  EXPECT_EQ(lab.frames[10].number, lab.frames[0].number + 10);
}

TEST(PaintedCamera, LostFramesLeaveGapsInTheNumbers) {
  PaintedLab lab(0.5);
  lab.watch();
  lab.run(2);
  EXPECT_GT(lab.frames.size(), 25U);
  EXPECT_LT(lab.frames.size(), 75U);
  const auto span = lab.frames.back().number - lab.frames.front().number;
  EXPECT_GT(span, static_cast<std::int64_t>(lab.frames.size()) + 10);
  for (const Taken& frame : lab.frames) {
    EXPECT_EQ((frame.utime - lab.frames[0].utime) / 20'000, frame.number - lab.frames[0].number);
  }
}

TEST(PaintedCamera, ShowsTheLightAndTheMovingRobot) {
  PaintedLab lab;
  lab.watch();
  lab.run(0.2);
  // The middle of the cap is white.
  const double dark = meanAround(lab.frames.back(), 0.30, 0.45);
  lab.light(1);
  lab.run(0.2);
  const double lit = meanAround(lab.frames.back(), 0.30, 0.45);
  EXPECT_LT(dark, 20);
  EXPECT_GT(lit, 180);
  lab.light(0.2);
  lab.run(0.2);
  EXPECT_NEAR(meanAround(lab.frames.back(), 0.30, 0.45), lit * 0.23 / 1.03, 6);
  // Then its big circle is where the middle was before.
  lab.light(1);
  lab.drive(-0.018);
  lab.run(1.2);
  const double x = 0.30 - 0.018 * 1.2;
  EXPECT_GT(meanAround(lab.frames.back(), x + 0.001, 0.45), 150);
  EXPECT_LT(meanAround(lab.frames.back(), x + 0.018, 0.45), 60);
}

TEST(PaintedCamera, UnwatchedFramesDoNotChangeLaterPictures) {
  PaintedLab early;
  early.watch();
  PaintedLab late;
  early.light(0.7);
  late.light(0.7);
  early.drive(0.03);
  late.drive(0.03);
  early.run(1);
  late.run(1);
  EXPECT_TRUE(late.frames.empty());
  late.watch();
  early.run(0.5);
  late.run(0.5);
  ASSERT_FALSE(late.frames.empty());
  EXPECT_EQ(late.frames.back().number, early.frames.back().number);
  EXPECT_EQ(late.frames.back().grey, early.frames.back().grey);
}

TEST(PaintedCamera, ASecondSimulatedCameraIsRefused) {
  PaintedLab lab;
  EXPECT_THROW(PaintedCamera(lab.experiment, lab.cameras, lab.loop), CameraError);
}

}  // namespace
}  // namespace lab::sim
