#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/loop/virtual_loop.hpp"
#include "light/optics/simulated_camera.hpp"
#include "sim_svc/camera/painted_camera.hpp"
#include "tracker_svc/tracker_service.hpp"

namespace lab::tracker::marker_service_test {
namespace {

/// A camera whose pictures the test delivers.
class GivenCamera final : public Cameras {
 public:
  [[nodiscard]] std::unique_ptr<FrameSource> open(const std::string& /*source*/,
                                                  const CameraFormat& wanted,
                                                  CameraHandlers handlers) override {
    to = std::move(handlers);
    return std::make_unique<Source>(wanted);
  }
  [[nodiscard]] std::unique_ptr<FrameSink> offer(const CameraFormat& /*format*/) override {
    throw CameraError("not here");
  }

  CameraHandlers to;

 private:
  class Source final : public FrameSource {
   public:
    explicit Source(CameraFormat format) : format_(std::move(format)) {}
    [[nodiscard]] CameraFormat format() const override { return format_; }
    [[nodiscard]] std::int64_t dropped() const override { return 0; }
    [[nodiscard]] std::int64_t length() const override { return 0; }

   private:
    CameraFormat format_;
  };
};

/// The service and the simulated camera of one experiment, in virtual time.
struct Bench {
  explicit Bench(Marker marker) {
    experiment.camera.tracker = Tracker::kCamera;
    experiment.camera.fps = 20;
    experiment.camera.marker = marker;
    experiment.camera.blob_smallest = 0.012;
    experiment.camera.blob_largest = 0.024;
    for (const sim::PaintedRobot& robot : robots) {
      RobotSpec spec;
      spec.id = robot.tag;
      experiment.robots.push_back(spec);
    }
    loop.drainWith([this] { bus.deliver(); });
    bus.subscribe(channels::kTrackedFrame,
                  [this](const Packet& packet) { ASSERT_TRUE(decode(packet.data, frame)); });
    painter = std::make_unique<sim::CameraPainter>(sim::painterSettings(experiment));
    light::Field field;
    field.layers.push_back({.intensity = 0.8});
    painter->setLight(field);
    const ServiceContext context{node, loop, experiment, testing::TempDir()};
    dut = std::make_unique<TrackerService>(ServiceContext{context.node, context.loop,
                                                          context.experiment, context.directory,
                                                          context.ports, context.programs, camera});
    node.start();
  }

  void film(int pictures) {
    for (int i = 0; i < pictures; ++i) {
      loop.runUntil(loop.now() + 50'000);
      for (sim::PaintedRobot& robot : robots) robot.x += 0.002;
      optics::GreyImage image(experiment.camera.width, experiment.camera.height);
      painter->paint(robots, number, image.pixels);
      camera.to.frame({number++, loop.now(), image.view()});
      bus.deliver();
    }
  }

  std::vector<sim::PaintedRobot> robots{
      {0.3, 0.3, 0.5, 0, 0, 0, 3}, {0.7, 0.3, 2.0, 0, 0, 0, 4}, {0.6, 0.65, -1.0, 0, 0, 0, 9}};
  VirtualLoop loop;
  MemoryBus bus{[this] { return loop.now(); }};
  Node node{bus, loop, {"tracker_svc", 0, 7}};
  Experiment experiment;
  GivenCamera camera;
  std::unique_ptr<sim::CameraPainter> painter;
  std::unique_ptr<TrackerService> dut;
  std::int64_t number = 0;
  tracked_frame_t frame{};
};

TEST(MarkerService, KnowsRobotsByTheirTagsAtOnce) {
  Bench bench(Marker::kTags);
  for (int picture = 0; picture < 4; ++picture) {
    bench.film(1);
    ASSERT_EQ(bench.frame.robots.size(), bench.robots.size()) << picture;
    for (std::size_t i = 0; i < bench.robots.size(); ++i) {
      const tracked_pose_t& pose = bench.frame.robots[i];
      const sim::PaintedRobot& robot = bench.robots[i];
      EXPECT_EQ(pose.robot_id, robot.tag);
      EXPECT_NEAR(pose.x, robot.x, 1e-4);
      EXPECT_NEAR(pose.y, robot.y, 1e-4);
      EXPECT_NEAR(std::remainder(pose.theta - robot.theta, 2 * std::numbers::pi), 0, 0.005);
    }
  }
}

TEST(MarkerService, FollowsBlobsWithoutIdentity) {
  Bench bench(Marker::kBlobs);
  bench.film(3);
  EXPECT_TRUE(bench.frame.robots.empty());
  // The dark side of a robot may be a blob too.
  EXPECT_LE(bench.frame.unidentified.size(), bench.robots.size() + 1);
  int matched = 0;
  for (const tracked_pose_t& pose : bench.frame.unidentified) {
    for (const sim::PaintedRobot& robot : bench.robots) {
      if (std::hypot(pose.x - robot.x, pose.y - robot.y) > 2e-4) continue;
      ++matched;
      EXPECT_GT(pose.covariance[5], 3);  // the heading of a disc is not known
    }
  }
  EXPECT_EQ(matched, 3);
}

}  // namespace
}  // namespace lab::tracker::marker_service_test
