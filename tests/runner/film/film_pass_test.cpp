// Films of several cameras, one of which is lost for a while, give the poses of the run again.
#include "runner/film/film_pass.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <lab/tracked_frame_t.hpp>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/bus/value_checker.hpp"
#include "common/camera/memory_cameras.hpp"
#include "common/camera/run_film.hpp"
#include "common/loop/virtual_loop.hpp"
#include "common/service/node.hpp"
#include "sim_svc/camera/painted_camera.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tracker_svc/tracker_service.hpp"

namespace lab::runner::film_pass_test {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kPeriod_us = 50'000;
constexpr double kPeriod = 0.05;  // [s]

/// Two cameras above an arena of 0.9 x 0.6 m, which share 24 cm.
Experiment twoCameras() {
  Experiment experiment;
  experiment.arena_width = 0.9;
  experiment.arena_height = 0.6;
  experiment.camera.tracker = Tracker::kCamera;
  experiment.camera.fps = 20;
  experiment.camera.width = 400;
  experiment.camera.height = 400;
  for (int i = 0; i < 2; ++i) {
    CameraSpec spec;
    spec.name = i == 0 ? "west" : "east";
    spec.view = {0.33 * i, 0, 0.57, 0.6};
    spec.clock_error = 0.003 * i;
    experiment.cameras.push_back(spec);
  }
  for (int id = 1; id <= 3; ++id) {
    RobotSpec spec;
    spec.id = id;
    experiment.robots.push_back(spec);
  }
  return experiment;
}

/// What remains of a frame without its header.
std::vector<std::uint8_t> posesOf(tracked_frame_t frame) {
  frame.sender.clear();
  frame.instance = frame.seq = 0;
  return encode(frame);
}

class FilmPassTest : public testing::Test {
 protected:
  /// Films robots that drive to and fro. A camera has a painter, or it is lost.
  void film(int pictures) {
    for (int i = 0; i < pictures; ++i) {
      const std::int64_t exposed = loop_.now();
      for (std::size_t k = 0; k < robots_.size(); ++k) {
        sim::PaintedRobot& robot = robots_[k];
        robot.theta = static_cast<double>(k);
        robot.vx = (number_ / 20 % 2 == 0 ? 0.06 : -0.06) * std::cos(robot.theta);
        robot.vy = (number_ / 20 % 2 == 0 ? 0.06 : -0.06) * std::sin(robot.theta);
        robot.x += robot.vx * kPeriod;
        robot.y += robot.vy * kPeriod;
      }
      for (const auto& painter : painters_) {
        if (painter) painter->take(number_, exposed, robots_);
      }
      ++number_;
      loop_.runUntil(exposed + kPeriod_us);
    }
  }

  void paint(std::size_t camera) {
    Experiment one = experiment_;
    one.camera = camerasOf(experiment_)[camera];
    painters_[camera] = std::make_unique<sim::PaintedCamera>(one, cameras_, loop_);
    light::Field field;
    field.layers.push_back({.intensity = 0.8});
    painters_[camera]->show(field);
  }

  /// The poses of the run, which is filmed; in its middle the camera "east" is lost for a while.
  std::vector<std::vector<std::uint8_t>> runAndFilm() {
    Experiment filmed = experiment_;
    filmed.camera.film.record = true;
    filmed.camera.film.codec = FilmCodec::kFfvhuff;
    std::vector<std::vector<std::uint8_t>> poses;
    bus_.subscribe(channels::kTrackedFrame, [&](const Packet& packet) {
      tracked_frame_t frame{};
      ASSERT_TRUE(decode(packet.data, frame));
      poses.push_back(posesOf(frame));
    });
    loop_.drainWith([this] { bus_.deliver(); });
    Node node(bus_, loop_, {"tracker_svc", 0, 7});
    const std::unique_ptr<Service> tracker =
        tracker::serviceDescription().make({.node = node,
                                            .loop = loop_,
                                            .experiment = filmed,
                                            .directory = folder_.path(),
                                            .cameras = cameras_});
    node.start();
    paint(0);
    paint(1);
    loop_.runUntil(loop_.now() + kPeriod_us);
    film(25);
    painters_[1].reset();
    film(10);
    paint(1);
    film(15);
    return poses;
  }

  TemporaryFolder folder_;
  Experiment experiment_ = twoCameras();
  VirtualLoop loop_;
  MemoryBus bus_{[this] { return loop_.now(); }};
  MemoryCameras cameras_{loop_};
  std::vector<std::unique_ptr<sim::PaintedCamera>> painters_{2};
  std::vector<sim::PaintedRobot> robots_ = [] {
    std::vector<sim::PaintedRobot> robots(3);
    for (std::size_t i = 0; i < robots.size(); ++i) {
      robots[i].x = 0.3 + 0.15 * static_cast<double>(i);
      robots[i].y = 0.15 + 0.15 * static_cast<double>(i);
    }
    return robots;
  }();
  std::int64_t number_ = 0;
};

TEST_F(FilmPassTest, GivesThePosesOfARunInWhichACameraWasLost) {
  const std::vector<std::vector<std::uint8_t>> poses = runAndFilm();
  ASSERT_EQ(poses.size(), 50U);
  const fs::path log = folder_.path() / "log.lcmlog";
  std::ofstream{log};
  const fs::path film = folder_.path() / "film";
  const std::vector<FilmFrame> west = readFilmTable(filmTableOf(film / "west/film.mkv"));
  ASSERT_EQ(west.size(), 50U);
  EXPECT_EQ(west[24].lost_cameras, 0U);
  EXPECT_EQ(west[25].lost_cameras, 2U);
  EXPECT_EQ(west[34].lost_cameras, 2U);
  EXPECT_EQ(west[36].lost_cameras, 0U);

  FilmPass dut({film / "east", film / "west"}, experiment_, folder_.path(), {log});
  std::vector<std::vector<std::uint8_t>> again;
  int frames = 0;
  while (dut.next()) {
    ++frames;
    for (const FilmPass::Round& round : dut.rounds()) {
      again.push_back(posesOf(round.poses));
      EXPECT_EQ(round.details.utime, round.poses.utime);
    }
  }

  EXPECT_EQ(frames, 90);
  EXPECT_TRUE(again == poses);
  EXPECT_EQ(dut.problem(), "");
  EXPECT_EQ(dut.lacking(), "");
}

TEST_F(FilmPassTest, NamesACameraThatTheExperimentDoesNotHave) {
  static_cast<void>(runAndFilm());
  std::ofstream{folder_.path() / "log.lcmlog"};
  experiment_.cameras[1].name = "other";

  try {
    FilmPass({folder_.path() / "film/east"}, experiment_, folder_.path(),
             {folder_.path() / "log.lcmlog"});
    FAIL();
  } catch (const CameraError& error) {
    EXPECT_NE(std::string(error.what()).find("film/east: found a film of camera east"),
              std::string::npos)
        << error.what();
  }
}

/// The tracker's timers would run for years.
TEST_F(FilmPassTest, RefusesAStartThatIsFarFromTheFrames) {
  static_cast<void>(runAndFilm());
  const fs::path log = folder_.path() / "log.lcmlog";
  std::ofstream{log};
  const fs::path east = folder_.path() / "film/east";
  const fs::path west = folder_.path() / "film/west";
  FilmFacts facts = readFilmFacts(east / film_files::kFacts);
  facts.start_utime = 0;
  ASSERT_TRUE(writeFilmFacts(east / film_files::kFacts, facts));
  const auto problem = [&](const std::vector<fs::path>& films) -> std::string {
    try {
      FilmPass(films, experiment_, folder_.path(), {log});
    } catch (const CameraError& error) {
      return error.what();
    }
    return "none";
  };

  EXPECT_THAT(problem({east}), testing::HasSubstr("film/east/film.json: start_utime: found 0, "
                                                  "expected at most 11 days before the first"));
  EXPECT_THAT(problem({east, west}),
              testing::HasSubstr("film/west/film.json: start_utime: found 946684800"));
  EXPECT_EQ(problem({west}), "none");
}

/// The log has times to the year 2100.
TEST_F(FilmPassTest, LetsAnHourPassAfterTheLastFrame) {
  static_cast<void>(runAndFilm());
  const fs::path log = folder_.path() / "log.lcmlog";
  std::ofstream{log};
  FilmPass dut({folder_.path() / "film/west"}, experiment_, folder_.path(), {log});
  while (dut.next()) {
  }
  const std::int64_t end = loop_.now();

  dut.passTime(ValueChecker::kLatestUtime);

  ASSERT_TRUE(dut.status());
  EXPECT_NEAR(static_cast<double>(dut.status()->utime - end), 3.6e9, 2e6);
}

}  // namespace
}  // namespace lab::runner::film_pass_test
