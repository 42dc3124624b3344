#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <lab/tracked_frame_t.hpp>
#include <lab/tracker_status_t.hpp>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/camera/memory_cameras.hpp"
#include "common/camera/run_film.hpp"
#include "common/loop/virtual_loop.hpp"
#include "sim_svc/camera/painted_camera.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tracker_svc/several_cameras_service.hpp"

namespace lab::tracker::several_cameras_test {
namespace {

constexpr std::int64_t kPeriod_us = 50'000;
constexpr double kPeriod = 0.05;  // [s]

/// Four cameras of 720 x 540 pixels above an arena of 1.2 x 0.9 m; neighbours share 24 cm.
Experiment fourCameras() {
  Experiment experiment;
  experiment.camera.tracker = Tracker::kCamera;
  experiment.camera.fps = 20;
  experiment.camera.width = 720;
  experiment.camera.height = 540;
  for (int i = 0; i < 4; ++i) {
    CameraSpec spec;
    spec.name = "c" + std::to_string(i + 1);
    spec.view = {i % 2 == 0 ? 0 : 0.48, i < 2 ? 0 : 0.36, 0.72, 0.54};
    spec.clock_error = 0.003 * i;
    experiment.cameras.push_back(spec);
  }
  return experiment;
}

/// The cameras, the service, and robots that drive straight across the seams.
struct Bench {
  explicit Bench(const FilmSpec& film = {}) {
    experiment.camera.film = film;
    constexpr double kSpeed = 0.06;  // [m/s]
    for (int i = 0; i < 6; ++i) {
      sim::PaintedRobot robot;
      const bool along_x = i < 3;
      robot.x = along_x ? 0.35 + 0.03 * i : 0.2 + 0.35 * (i - 3);
      robot.y = along_x ? 0.15 + 0.3 * i : 0.32;
      robot.theta = along_x ? 0 : M_PI / 2;
      if (i % 2 == 1) {
        robot.theta += M_PI;
        (along_x ? robot.x : robot.y) += along_x ? 0.5 : 0.26;
      }
      robot.vx = kSpeed * std::cos(robot.theta);
      robot.vy = kSpeed * std::sin(robot.theta);
      robots.push_back(robot);
    }
    for (int id = 1; id <= 6; ++id) {
      RobotSpec spec;
      spec.id = id;
      experiment.robots.push_back(spec);
    }
    loop.drainWith([this] { bus.deliver(); });
    bus.subscribe(channels::kTrackedFrame, [this](const Packet& packet) {
      ASSERT_TRUE(decode(packet.data, frame));
      ++frames;
    });
    bus.subscribe(channels::kTrackerStatus,
                  [this](const Packet& packet) { ASSERT_TRUE(decode(packet.data, status)); });
    light::Field field;
    field.layers.push_back({.intensity = 0.8});
    for (const Camera& camera : camerasOf(experiment)) {
      Experiment one = experiment;
      one.camera = camera;
      painters.push_back(std::make_unique<sim::PaintedCamera>(one, cameras, loop));
      painters.back()->show(field);
    }
    const ServiceContext context{node, loop, experiment, folder.path()};
    dut = std::make_unique<SeveralCamerasService>(
        ServiceContext{context.node, context.loop, context.experiment, context.directory,
                       context.ports, context.programs, cameras});
    node.start();
    loop.runUntil(loop.now() + kPeriod_us);
  }

  /// Drives and films.
  void film(int pictures) {
    for (int i = 0; i < pictures; ++i) {
      exposed = loop.now();
      for (sim::PaintedRobot& robot : robots) {
        robot.x += robot.vx * kPeriod;
        robot.y += robot.vy * kPeriod;
      }
      for (auto& painter : painters) {
        if (painter) painter->take(number, exposed, robots);
      }
      ++number;
      loop.runUntil(exposed + kPeriod_us);
    }
  }

  /// [m] distance of the nearest pose of the last frame from each robot, at the frame's time
  [[nodiscard]] std::vector<double> errors() const {
    const double late = static_cast<double>(frame.utime - exposed) * 1e-6;
    std::vector<double> list;
    for (const sim::PaintedRobot& robot : robots) {
      double nearest = 1;
      for (const tracked_pose_t& pose : frame.unidentified) {
        nearest = std::min(nearest, std::hypot(pose.x - robot.x - robot.vx * late,
                                               pose.y - robot.y - robot.vy * late));
      }
      list.push_back(nearest);
    }
    return list;
  }

  TemporaryFolder folder;
  std::vector<sim::PaintedRobot> robots;
  VirtualLoop loop;
  MemoryBus bus{[this] { return loop.now(); }};
  Node node{bus, loop, {"tracker_svc", 0, 7}};
  Experiment experiment = fourCameras();
  MemoryCameras cameras{loop};
  std::vector<std::unique_ptr<sim::PaintedCamera>> painters;
  std::unique_ptr<SeveralCamerasService> dut;
  std::int64_t number = 0;
  std::int64_t exposed = 0;
  int frames = 0;
  tracked_frame_t frame{};
  tracker_status_t status{};
};

TEST(SeveralCameras, SeamsAreBelow0p3MillimetresAndClocksAreFound) {
  Bench bench;
  double before = 0;
  double after = 0;
  // Robots drive to and fro: in one direction, an offset of a clock looks like a calibration that
  // differs.
  for (int picture = 0; picture < 120; ++picture) {
    bench.film(1);
    ASSERT_EQ(bench.frame.unidentified.size(), 6U) << picture;
    const double worst = std::ranges::max(bench.errors());
    (picture < 90 ? before : after) = std::max(picture < 90 ? before : after, worst);
    if (picture % 30 != 29) continue;
    for (sim::PaintedRobot& robot : bench.robots) {
      robot.vx = -robot.vx;
      robot.vy = -robot.vy;
    }
  }
  EXPECT_EQ(bench.frames, 120);
  // 9 ms at 6 cm/s are 0.54 mm until the offsets of the clocks are known.
  EXPECT_LT(before, 8e-4);
  EXPECT_LT(after, 3e-4);
  RecordProperty("seam_error_um", static_cast<int>(std::lround(after * 1e6)));
  bench.loop.runUntil(bench.loop.now() + 1'000'000);
  EXPECT_THAT(bench.status.camera,
              testing::MatchesRegex("c1, c2 .clock .*, c4 .clock .* ms, calibration .* mm."));
  const auto clockOf = [&](const std::string& name) {
    const std::size_t at = bench.status.camera.find(name + " (clock ");
    return at == std::string::npos ? 0.0 : std::stod(bench.status.camera.substr(at + 10));
  };
  EXPECT_NEAR(clockOf("c2"), 3, 0.5);  // [ms]
  EXPECT_NEAR(clockOf("c3"), 6, 0.5);
  EXPECT_NEAR(clockOf("c4"), 9, 0.5);
}

TEST(SeveralCameras, ADeadCameraCostsOnlyItsPartAndAMark) {
  Bench bench;
  bench.film(10);
  ASSERT_EQ(bench.frame.unidentified.size(), 6U);
  bench.painters[3].reset();  // sees alone x > 0.72 m and y > 0.54 m
  bench.film(10);
  EXPECT_EQ(bench.frames, 20);
  const std::vector<double> errors = bench.errors();
  for (std::size_t i = 0; i < bench.robots.size(); ++i) {
    const sim::PaintedRobot& robot = bench.robots[i];
    constexpr double kCap = 0.04;  // [m] from the edge of a view
    const bool surely_seen = robot.x < 0.72 - kCap || robot.y < 0.54 - kCap;
    if (!surely_seen) continue;
    EXPECT_LT(errors[i], 8e-4) << i;
  }
  EXPECT_EQ(bench.status.state, tracker_status_t::RUNNING);
  EXPECT_THAT(bench.status.warning, testing::HasSubstr("camera c4 is lost"));
  EXPECT_EQ(bench.status.trouble, "");
  for (auto& painter : bench.painters) painter.reset();
  bench.loop.runUntil(bench.loop.now() + 1'500'000);
  EXPECT_EQ(bench.status.state, tracker_status_t::GONE);
}

TEST(SeveralCameras, AFilmEndsWithItsCameraAndTheOthersGoOn) {
  FilmSpec film;
  film.record = true;
  film.codec = FilmCodec::kFfvhuff;
  Bench bench(film);
  bench.film(4);
  bench.painters[3].reset();
  bench.film(4);
  bench.dut.reset();  // completes the films

  for (const char* camera : {"c1", "c2", "c3", "c4"}) {
    const auto folder = bench.folder.path() / "film" / camera;
    const FilmFacts facts = readFilmFacts(folder / film_files::kFacts);
    const std::int64_t frames = camera == std::string("c4") ? 4 : 8;
    EXPECT_EQ(facts.camera, camera);
    EXPECT_EQ(facts.frames, frames) << camera;
    EXPECT_TRUE(facts.complete);
    EXPECT_EQ(facts.problem, "");
    const std::vector<FilmFrame> table = readFilmTable(filmTableOf(folder / film_files::kMovie));
    ASSERT_EQ(std::ssize(table), frames);
    EXPECT_EQ(table.back().number, frames - 1);
    EXPECT_TRUE(table.back().searched);
    EXPECT_EQ(table.back().lost_cameras, frames == 4 ? 0U : 8U);
  }
}

}  // namespace
}  // namespace lab::tracker::several_cameras_test
