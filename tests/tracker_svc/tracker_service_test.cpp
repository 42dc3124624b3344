#include "tracker_svc/tracker_service.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <lab/service_status_t.hpp>
#include <numbers>
#include <string_view>

#include "common/bus/channels.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/loop/virtual_loop.hpp"
#include "light/optics/simulated_camera.hpp"
#include "sim_svc/camera_painter.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/tracker_svc/covered_cap.hpp"

namespace lab::tracker {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr std::int64_t kFrame_us = 50'000;
constexpr std::int64_t kReport_us = 10'000;

/// A camera that delivers the pictures of the test.
class ScriptedCameras final : public Cameras {
 public:
  [[nodiscard]] std::unique_ptr<FrameSource> open(const std::string& source,
                                                  const CameraFormat& wanted,
                                                  CameraHandlers handlers) override {
    opened = source;
    format = wanted;
    to = std::move(handlers);
    return std::make_unique<Source>(*this);
  }
  [[nodiscard]] std::unique_ptr<FrameSink> offer(const CameraFormat&) override {
    throw CameraError("not here");
  }

  std::string opened;
  CameraFormat format;
  CameraHandlers to;
  std::int64_t dropped = 0;
  std::int64_t length = 0;

 private:
  class Source final : public FrameSource {
   public:
    explicit Source(ScriptedCameras& cameras) : cameras_(cameras) {}
    [[nodiscard]] CameraFormat format() const override { return cameras_.format; }
    [[nodiscard]] std::int64_t dropped() const override { return cameras_.dropped; }
    [[nodiscard]] std::int64_t length() const override { return cameras_.length; }

   private:
    ScriptedCameras& cameras_;
  };
};

/// The service with a scripted camera, in virtual time, and robots moved by the test.
class TrackerServiceTest : public testing::Test {
 protected:
  TrackerServiceTest() {
    experiment.camera.tracker = Tracker::kCamera;
    experiment.camera.fps = 20;
    experiment.camera.width = 640;
    experiment.camera.height = 480;
    loop.drainWith([this] { bus.deliver(); });
    keep(channels::kTrackedFrame, frames);
    keep(channels::kTrackedDetails, details);
    keep(channels::kTrackerStatus, statuses);
    keep(channels::kServiceStatus, heartbeats);
  }

  template <class Message>
  void keep(std::string_view channel, std::vector<Message>& into) {
    bus.subscribe(channel, [&into](const Packet& packet) {
      Message message{};
      ASSERT_TRUE(decode(packet.data, message));
      into.push_back(message);
    });
  }

  void start(std::vector<sim::PaintedRobot> where) {
    robots = std::move(where);
    for (std::size_t i = 0; i < robots.size(); ++i) {
      RobotSpec spec;
      spec.id = static_cast<std::int32_t>(i) + 1;
      experiment.robots.push_back(spec);
    }
    sim::PainterSettings settings;
    settings.camera =
        optics::simulatedCamera(experiment.camera.width, experiment.camera.height, 1.2, 0.9);
    settings.imaging.gamma = gamma;
    painter = std::make_unique<sim::CameraPainter>(settings);
    light(1);
    ServiceContext context{node, loop, experiment, testing::TempDir()};
    ServiceContext with{
        context.node,     context.loop, context.experiment, context.directory, context.ports,
        context.programs, cameras};
    dut = std::make_unique<TrackerService>(with);
    node.start();
  }

  void light(double intensity) {
    light::Field field;
    field.layers.push_back({.intensity = intensity});
    painter->setLight(field);
  }

  void show(const optics::GreyImage& image) {
    cameras.to.frame({number++, loop.now(), image.view()});
    bus.deliver();
  }

  void sayWheels() {
    robot_status_t status{};
    for (std::size_t k = 0; k < robots.size(); ++k) {
      robot_state_t state{};
      state.robot_id = static_cast<std::int32_t>(k) + 1;
      state.utime = loop.now();
      state.wheel_right = robots[k].omega * experiment.hardware.diameter / 2;
      state.wheel_left = -state.wheel_right;
      status.robots.push_back(state);
    }
    status.num_robots = static_cast<std::int32_t>(status.robots.size());
    bridge.publish(channels::kRobotStatus, status);
    bus.deliver();
  }

  /// Moves the robots for one frame, publishes their reports and takes a picture.
  void film(int pictures = 1) {
    for (int i = 0; i < pictures; ++i) {
      const std::int64_t end = loop.now() + kFrame_us;
      for (; loop.now() < end; loop.runUntil(loop.now() + kReport_us)) sayWheels();
      for (sim::PaintedRobot& robot : robots) {
        robot.theta =
            std::remainder(robot.theta + robot.omega * kFrame_us * 1e-6, 2 * std::numbers::pi);
      }
      optics::GreyImage image(experiment.camera.width, experiment.camera.height);
      painter->paint(robots, number, image.pixels);
      const optics::CameraModel camera(painter->settings().camera);
      for (const detector::Cover& cover : covers) detector::lay(cover, camera, image);
      show(image);
    }
  }

  /// Turns each robot to and fro while the others stand, which identifies it.
  void handshake() {
    for (sim::PaintedRobot& robot : robots) {
      for (const double turn : {2.0, -2.0, 2.0, -2.0, 2.0, -2.0}) {
        robot.omega = turn;
        film(10);
      }
      robot.omega = 0;
    }
    film(10);
  }

  VirtualLoop loop;
  MemoryBus bus{[this] { return loop.now(); }};
  Node node{bus, loop, {"tracker_svc", 0, 7}};
  Node bridge{bus, loop, {"sim_svc", 2, 1}};
  Experiment experiment;
  ScriptedCameras cameras;
  std::unique_ptr<sim::CameraPainter> painter;
  std::unique_ptr<TrackerService> dut;
  std::vector<sim::PaintedRobot> robots;
  std::vector<detector::Cover> covers;  ///< covers over caps
  double gamma = 1;                     ///< of the camera's grey values
  std::int64_t number = 0;
  std::vector<tracked_frame_t> frames;
  std::vector<tracked_details_t> details;
  std::vector<tracker_status_t> statuses;
  std::vector<service_status_t> heartbeats;
};

const std::vector<sim::PaintedRobot> kThree = {{0.3, 0.3, 0.5}, {0.7, 0.3, 2.0}, {0.6, 0.65, -1.0}};

TEST_F(TrackerServiceTest, PublishesUnidentifiedCapsUntilEachRobotHasTurned) {
  start(kThree);
  film();
  ASSERT_THAT(frames, SizeIs(1));
  EXPECT_THAT(frames[0].robots, IsEmpty());
  EXPECT_THAT(frames[0].unidentified, SizeIs(3));
  EXPECT_EQ(frames[0].origin, robot_state_t::SIM);
  EXPECT_EQ(frames[0].frame_period, 0.05);
  handshake();
  const tracked_frame_t& last = frames.back();
  EXPECT_THAT(last.unidentified, IsEmpty());
  ASSERT_THAT(last.robots, SizeIs(3));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(last.robots[i].robot_id, static_cast<std::int32_t>(i) + 1);
    EXPECT_NEAR(last.robots[i].x, robots[i].x, 3e-4);
    EXPECT_NEAR(last.robots[i].y, robots[i].y, 3e-4);
    EXPECT_NEAR(std::remainder(last.robots[i].theta - robots[i].theta, 2 * std::numbers::pi), 0,
                0.01);
    EXPECT_GT(last.robots[i].confidence, 0.5);
    EXPECT_GT(last.robots[i].covariance[0], 0);
  }
  ASSERT_THAT(details.back().caps, SizeIs(3));
  EXPECT_EQ(details.back().frame, last.frame);
  EXPECT_EQ(details.back().utime, last.utime);
  EXPECT_EQ(details.back().caps[0].used, cap_detail_t::USED_BIG | cap_detail_t::USED_SMALL);
  EXPECT_NEAR(details.back().caps[0].spacing, 0.036, 2e-4);
  EXPECT_EQ(statuses.back().bindings, 3);
  EXPECT_EQ(statuses.back().caps, 3);
  EXPECT_EQ(statuses.back().unbound, 0);
}

TEST_F(TrackerServiceTest, KeepsARobotWithOneCoveredCircleAndMarksThePose) {
  start(kThree);
  handshake();
  for (const bool big : {true, false}) {
    covers = {detector::overCircle(robots[1], big)};
    film(40);  // includes two searches of the whole picture
    ASSERT_THAT(frames.back().robots, SizeIs(3));
    const tracked_pose_t& pose = frames.back().robots[1];
    EXPECT_EQ(pose.robot_id, 2);
    EXPECT_NEAR(pose.x, robots[1].x, 1e-3);
    EXPECT_NEAR(std::remainder(pose.theta - robots[1].theta, 2 * std::numbers::pi), 0, 0.06);
    EXPECT_GT(pose.confidence, 0);
    EXPECT_LT(pose.confidence, 0.5);
    EXPECT_GT(pose.covariance[0], frames.back().robots[0].covariance[0]);
    const cap_detail_t& detail = details.back().caps[1];
    EXPECT_EQ(detail.used,
              cap_detail_t::USED_RIM | (big ? cap_detail_t::USED_SMALL : cap_detail_t::USED_BIG));
    EXPECT_EQ(detail.spacing, 0);
    EXPECT_GT(frames.back().robots[0].confidence, 0.5);
  }
  covers = {detector::overCircle(robots[1], true), detector::overCircle(robots[1], false)};
  film(2);
  EXPECT_THAT(frames.back().robots, SizeIs(2)) << "what is not seen is not said";
  covers.clear();
  film(2);
  ASSERT_THAT(frames.back().robots, SizeIs(3));
  EXPECT_GT(frames.back().robots[1].confidence, 0.5);
  EXPECT_EQ(statuses.back().unbindings, 0);
}

TEST_F(TrackerServiceTest, ReportsTheStateOfTheCamera) {
  start(kThree);
  cameras.format.pixels = "GREY";
  cameras.format.locked = true;
  cameras.dropped = 4;
  film(25);
  EXPECT_EQ(cameras.opened, "sim");
  const tracker_status_t& status = statuses.back();
  EXPECT_EQ(status.state, tracker_status_t::RUNNING);
  EXPECT_EQ(status.camera, "sim");
  EXPECT_EQ(status.width, 640);
  EXPECT_EQ(status.pixels, "GREY");
  EXPECT_EQ(status.locked, 1);
  EXPECT_EQ(status.dropped, 4);
  EXPECT_GT(status.spacings, 50);
  EXPECT_EQ(status.moved, 0) << status.warning;
  EXPECT_EQ(status.latency_p99, 0);  // virtual time
}

TEST_F(TrackerServiceTest, DetectsAndReportsAGammaEncodingCamera) {
  const TemporaryFolder folder;
  CameraCalibration calibration;
  calibration.camera =
      optics::simulatedCamera(experiment.camera.width, experiment.camera.height, 1.2, 0.9);
  std::ofstream(folder / "camera.json") << cameraFileText(calibration);
  experiment.camera.calibration = (folder / "camera.json").string();
  gamma = 2.2;
  start(kThree);
  cameras.format.pixels = "YUYV";
  film(25);
  EXPECT_THAT(frames.front().unidentified, SizeIs(3));
  EXPECT_THAT(frames.back().unidentified, SizeIs(3));
  EXPECT_EQ(statuses.back().pixels, "YUYV, gamma 2.2");
}

TEST_F(TrackerServiceTest, CountsBlackAndSaturatedPicturesWithoutDetections) {
  start(kThree);
  film(3);
  frames.clear();
  loop.runUntil(loop.now() + kFrame_us);
  show(optics::GreyImage(640, 480, 2));
  loop.runUntil(loop.now() + kFrame_us);
  show(optics::GreyImage(640, 480, 255));
  ASSERT_THAT(frames, SizeIs(2));
  for (const tracked_frame_t& frame : frames) {
    EXPECT_THAT(frame.robots, IsEmpty());
    EXPECT_THAT(frame.unidentified, IsEmpty());
  }
  film(20);
  EXPECT_EQ(statuses.back().dark, 1);
  EXPECT_EQ(statuses.back().saturated, 1);
  EXPECT_THAT(frames.back().unidentified, SizeIs(3));
}

TEST_F(TrackerServiceTest, ReportsABlindCameraAndTheReason) {
  start(kThree);
  film(3);
  const auto blindFor = [this](int pictures, std::uint8_t grey) {
    for (int i = 0; i < pictures; ++i) {
      loop.runUntil(loop.now() + kFrame_us);
      show(optics::GreyImage(640, 480, grey));
    }
  };
  blindFor(9 * 20, 2);
  EXPECT_THAT(statuses.back().warning, IsEmpty()) << "a script may be black for a while";
  blindFor(3 * 20, 2);
  EXPECT_THAT(statuses.back().warning, AllOf(HasSubstr("no cap was seen"), HasSubstr("too dark")));
  EXPECT_THAT(heartbeats.back().last_error, HasSubstr("too dark"));
  film(25);
  EXPECT_THAT(statuses.back().warning, IsEmpty());
  blindFor(12 * 20, 255);
  EXPECT_THAT(statuses.back().warning, HasSubstr("too bright"));
  film(25);
  blindFor(12 * 20, 30);
  EXPECT_THAT(statuses.back().warning, AllOf(HasSubstr("no pixel is below 30 grey steps"),
                                             HasSubstr("and not at 2 (imaging.black_dn")));
}

TEST_F(TrackerServiceTest, RejectsPicturesOfAnotherSizeAndContinuesWhenTheyFit) {
  start(kThree);
  loop.runUntil(loop.now() + kFrame_us);
  show(optics::GreyImage(1280, 720, 100));
  EXPECT_THAT(frames, IsEmpty());
  EXPECT_THAT(statuses.back().trouble,
              AllOf(HasSubstr("1280 x 720"), HasSubstr("640 x 480"), HasSubstr("calibrate")));
  EXPECT_EQ(heartbeats.back().state, service_status_t::FAULT);
  const std::size_t said = statuses.size();
  show(optics::GreyImage(1280, 720, 100));
  EXPECT_EQ(statuses.size(), said) << "says it once";
  film(2);
  EXPECT_THAT(frames, SizeIs(2));
  EXPECT_THAT(statuses.back().trouble, IsEmpty());
  EXPECT_EQ(heartbeats.back().state, service_status_t::READY);
}

TEST_F(TrackerServiceTest, ReportsALostCameraAndContinuesWhenItIsBack) {
  start(kThree);
  film(3);
  cameras.to.trouble("/dev/video0: unplugged");
  bus.deliver();
  EXPECT_EQ(statuses.back().state, tracker_status_t::GONE);
  EXPECT_EQ(statuses.back().trouble, "/dev/video0: unplugged");
  EXPECT_EQ(heartbeats.back().state, service_status_t::FAULT);
  cameras.to.trouble("");
  film(3);
  EXPECT_EQ(heartbeats.back().state, service_status_t::READY);
  EXPECT_EQ(statuses.back().state, tracker_status_t::RUNNING);
  EXPECT_THAT(frames, SizeIs(6));
}

TEST_F(TrackerServiceTest, TheTrackerStartedSecondStaysSilent) {
  start(kThree);
  film(2);
  Node older(bus, loop, {"tracker_svc", 0, 3});
  tracked_frame_t other{};
  older.publish(channels::kTrackedFrame, other);
  bus.deliver();
  const std::size_t said = frames.size();
  film(2);
  EXPECT_EQ(frames.size(), said);
  EXPECT_THAT(heartbeats.back().last_error, HasSubstr("another tracker (instance 3)"));
  film(50);  // the other tracker has stopped
  EXPECT_GT(frames.size(), said);
}

TEST_F(TrackerServiceTest, TheTrackerStartedFirstContinues) {
  start(kThree);
  film(2);
  Node younger(bus, loop, {"tracker_svc", 0, 9});
  tracked_frame_t other{};
  younger.publish(channels::kTrackedFrame, other);
  bus.deliver();
  const std::size_t said = frames.size();
  film(2);
  EXPECT_EQ(frames.size(), said + 2);
}

TEST_F(TrackerServiceTest, ARecordingIsAReplayThatStartsNow) {
  experiment.camera.source = "film.mkv";
  cameras.length = 100;
  start(kThree);
  loop.runUntil(loop.now() + kFrame_us);
  const std::int64_t begun = loop.now();
  optics::GreyImage image(640, 480);
  painter->paint(robots, 0, image.pixels);
  cameras.to.frame({0, 0, image.view()});
  cameras.to.frame({1, 40'000, image.view()});
  bus.deliver();
  ASSERT_THAT(frames, SizeIs(2));
  EXPECT_EQ(frames[0].origin, robot_state_t::REPLAY);
  EXPECT_EQ(frames[0].utime, begun);
  EXPECT_EQ(frames[1].utime, begun + 40'000);
  cameras.to.end("film.mkv: ends early: 2 of 100 frames");
  bus.deliver();
  EXPECT_EQ(statuses.back().state, tracker_status_t::ENDED);
  EXPECT_THAT(statuses.back().trouble, HasSubstr("ends early"));
}

}  // namespace
}  // namespace lab::tracker
