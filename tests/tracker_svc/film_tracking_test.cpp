#include "tracker_svc/film_tracking.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <span>
#include <vector>

#include "tests/tracker_svc/covered_cap.hpp"
#include "tests/tracker_svc/painted_film.hpp"
#include "tracker_svc/detector.hpp"
#include "tracker_svc/tracking/cap_tracker.hpp"

namespace lab::tracker::film_tracking_test {
namespace {

constexpr double kNear = 1e-4;  // [m] detection error at 640 x 480, with a large margin

struct Bench {
  PaintedFilm film;
  detector::Detector detector{optics::CameraModel(PaintedFilm::settings().camera),
                              optics::CapGeometry{}};
  CapTracker caps{TrackerSettings{}, {}};
};

/// Index of the robot at this pose, -1 if none.
int robotAt(const FilmRow& row, const std::vector<sim::PaintedRobot>& robots) {
  for (std::size_t i = 0; i < robots.size(); ++i) {
    if (std::hypot(row.pose.x - robots[i].x, row.pose.y - robots[i].y) < kNear) {
      return static_cast<int>(i);
    }
  }
  return -1;
}

TEST(FilmTracking, TracksEveryRobotUnderOneId) {
  Bench bench;
  FilmTracking dut(bench.detector, bench.caps);
  std::map<int, std::set<std::int64_t>> ids;

  for (std::int64_t k = 0; k < 12; ++k) {
    const double time = PaintedFilm::timeOf(k);
    const optics::GreyImage picture = bench.film.frame(k);
    const std::vector<FilmRow>& rows = dut.process(k, time, picture.view());
    ASSERT_EQ(rows.size(), 3U);
    for (const FilmRow& row : rows) {
      ids[robotAt(row, PaintedFilm::robotsAt(time))].insert(row.id);
      EXPECT_EQ(row.frame, k);
      EXPECT_EQ(row.time, time);
    }
  }

  ASSERT_EQ(ids.size(), 3U);
  EXPECT_EQ(ids.count(-1), 0U);
  for (const auto& [robot, its_ids] : ids) {
    EXPECT_EQ(its_ids.size(), 1U) << robot;
    EXPECT_GE(*its_ids.begin(), 1);
  }
  EXPECT_EQ(dut.summary().ids, 3);
}

TEST(FilmTracking, KeepsIdsOverAMissingFrame) {
  Bench bench;
  FilmTracking dut(bench.detector, bench.caps);

  for (const std::int64_t k : {0, 1, 2, 3, 5, 6, 8}) {
    const optics::GreyImage picture = bench.film.frame(k);
    static_cast<void>(dut.process(k, PaintedFilm::timeOf(k), picture.view()));
  }

  EXPECT_EQ(dut.summary().ids, 3);
  EXPECT_EQ(dut.summary().missing, 2);
  EXPECT_EQ(dut.summary().frames, 7);
  EXPECT_EQ(dut.summary().rows, 21);
}

TEST(FilmTracking, AcceptsUnrelatedPictures) {
  Bench bench;
  FilmTracking dut(bench.detector, bench.caps);
  const std::vector<std::vector<sim::PaintedRobot>> stills{
      {{0.2, 0.2, 0.5}, {0.6, 0.4, 2}, {1.0, 0.7, -1}},
      {{0.9, 0.2, -3}, {0.6, 0.4, 2 - std::numbers::pi}},  // one at a former place, reversed
      {},
      {{0.3, 0.8, 1}, {0.7, 0.1, 0}, {0.5, 0.5, 3}, {1.1, 0.4, 1}}};

  std::int64_t number = 0;
  for (const std::vector<sim::PaintedRobot>& robots : stills) {
    const optics::GreyImage picture = bench.film.paint(robots, number);
    const std::vector<FilmRow>& rows =
        dut.process(number, 0, picture.view());  // all times are equal
    ASSERT_EQ(rows.size(), robots.size()) << number;
    for (const FilmRow& row : rows) {
      const int robot = robotAt(row, robots);
      ASSERT_GE(robot, 0) << number;
      const double off = row.pose.theta - robots[static_cast<std::size_t>(robot)].theta;
      EXPECT_LT(std::abs(std::remainder(off, 2 * std::numbers::pi)), 0.02) << number;
    }
    ++number;
  }
  EXPECT_EQ(dut.summary().fewest, 0);
  EXPECT_EQ(dut.summary().most, 4);
}

TEST(FilmTracking, ReportsAtMostTheGivenNumberOfRobots) {
  Bench bench;
  FilmTracking dut(bench.detector, bench.caps, 2);
  const optics::GreyImage picture = bench.film.frame(0);

  EXPECT_EQ(dut.process(0, 0, picture.view()).size(), 2U);
  EXPECT_EQ(dut.summary().surplus, 1);
}

/// Finds more in a picture than anybody marks, as in noise.
class Noise : public detector::MarkerDetector {
 public:
  Noise() {
    for (std::size_t i = 0; i < FilmTracking::kMostDetections + 7; ++i) {
      detector::Detection detection;
      detection.x = 0.01 * static_cast<double>(i);
      detection.quality = i < 7 ? 0.25F : 0.75F;
      found_.push_back(detection);
    }
  }
  const std::vector<detector::Detection>& search(
      const optics::GreyView& /*picture*/, std::vector<detector::Rejection>* /*rejected*/,
      std::span<const detector::Expected> /*expected*/) override {
    return found_;
  }
  const std::vector<detector::Detection>& follow(
      const optics::GreyView& /*picture*/,
      std::span<const detector::Expected> /*expected*/) override {
    return found_;
  }
  void setCompressed(bool /*compressed*/) override {}
  void setGamma(double /*gamma*/) override {}
  [[nodiscard]] const optics::CameraModel& camera() const override { return camera_; }

 private:
  optics::CameraModel camera_{PaintedFilm::settings().camera};
  std::vector<detector::Detection> found_;
};

class NoTracks : public MarkerTracker {
 public:
  const std::vector<detector::Expected>& expect(double /*time*/) override { return expected_; }
  const std::vector<Track>& update(double /*time*/,
                                   std::span<const detector::Detection> detections) override {
    least_ = 1;
    for (const detector::Detection& one : detections) least_ = std::min(least_, one.quality);
    return tracks_;
  }
  [[nodiscard]] const TrackerCounts& counts() const override { return counts_; }
  [[nodiscard]] float least() const { return least_; }

 private:
  std::vector<detector::Expected> expected_;
  std::vector<Track> tracks_;
  TrackerCounts counts_;
  float least_ = 0;
};

TEST(FilmTracking, ReportsTheBestOfTooManyDetections) {
  Noise noise;
  NoTracks tracker;
  FilmTracking dut(noise, tracker);
  const optics::GreyImage picture(4, 4);

  EXPECT_EQ(dut.process(0, 0, picture.view()).size(), FilmTracking::kMostDetections);
  EXPECT_EQ(dut.summary().surplus, 7);
  EXPECT_EQ(dut.summary().crowded, 1);
  EXPECT_EQ(tracker.least(), 0.75F);
}

TEST(FilmTracking, MeasuresTheSpacingOfTheCircles) {
  Bench bench;
  FilmTracking dut(bench.detector, bench.caps);
  const optics::GreyImage picture = bench.film.frame(0);
  static_cast<void>(dut.process(0, 0, picture.view()));

  const FilmSummary summary = dut.summary();

  EXPECT_NEAR(summary.spacing, optics::CapGeometry{}.spacing(), 1e-4);
  EXPECT_GT(summary.spacing_spread, 0);
  EXPECT_GT(summary.confidence, 0.5);
}

TEST(FilmTracking, ReportsRejectedCandidates) {
  Bench bench;
  FilmTracking dut(bench.detector, bench.caps);
  sim::PainterSettings settings = PaintedFilm::settings();
  settings.discs = {{0.5, 0.5, 0.009, 0.07}};  // a big circle without a partner
  sim::CameraPainter painter(settings);
  light::Layer light;
  light.intensity = 0.8;
  painter.setLight({{light}, {}, 1});
  optics::GreyImage picture(PaintedFilm::kWidth, PaintedFilm::kHeight);
  painter.paint({}, 0, picture.pixels);
  std::vector<detector::Rejection> rejected;

  EXPECT_TRUE(dut.process(0, 0, picture.view(), &rejected).empty());

  const optics::Pixel disc = optics::CameraModel(settings.camera).project(0.5, 0.5, 0);
  const bool there =
      std::any_of(rejected.begin(), rejected.end(), [&](const detector::Rejection& one) {
        return std::hypot(one.where.x - disc.x, one.where.y - disc.y) < 3;
      });
  EXPECT_TRUE(there);
}

TEST(FilmTracking, KeepsACapWhileOneCircleIsCovered) {
  Bench bench;
  FilmTracking dut(bench.detector, bench.caps);
  constexpr std::size_t kCovered = 1;
  std::set<std::int64_t> ids;

  for (std::int64_t k = 0; k < 14; ++k) {
    const double time = PaintedFilm::timeOf(k);
    const std::vector<sim::PaintedRobot> robots = PaintedFilm::robotsAt(time);
    optics::GreyImage picture = bench.film.frame(k);
    const bool covered = k >= 3 && k < 10;
    if (covered)
      detector::lay(detector::overCircle(robots[kCovered], false), bench.detector.camera(),
                    picture);
    const std::vector<FilmRow>& rows = dut.process(k, time, picture.view());
    ASSERT_EQ(rows.size(), 3U) << k;
    for (const FilmRow& row : rows) {
      const sim::PaintedRobot& robot = robots[kCovered];
      const bool is_it = std::hypot(row.pose.x - robot.x, row.pose.y - robot.y) < 0.001;
      EXPECT_EQ((row.pose.used & detector::kUsedRim) != 0, is_it && covered) << k;
      EXPECT_EQ(row.pose.quality < 0.5F, is_it && covered) << k;
      if (is_it) ids.insert(row.id);
    }
  }

  EXPECT_EQ(ids.size(), 1U);
  EXPECT_EQ(dut.summary().ids, 3);
  EXPECT_EQ(dut.summary().degraded, 7);
}

TEST(FilmTracking, StartsNoTrackFromOneCircle) {
  Bench bench;
  FilmTracking dut(bench.detector, bench.caps);
  optics::GreyImage picture = bench.film.frame(0);
  detector::lay(detector::overCircle(PaintedFilm::robotsAt(0)[0], true), bench.detector.camera(),
                picture);

  EXPECT_EQ(dut.process(0, 0, picture.view()).size(), 2U);
  EXPECT_EQ(dut.process(1, 1 / PaintedFilm::kFps, picture.view()).size(), 2U);
}

TEST(FilmCsv, WritesTheColumnsOfItsHeader) {
  FilmRow row;
  row.frame = 12;
  row.id = 3;
  row.time = 0.4;
  row.pose.x = 0.123456789;
  row.pose.y = -0.01;
  row.pose.theta = -3.14159265;
  row.pose.quality = 0.97F;
  row.pose.middle = {640.125, 360.5};

  EXPECT_EQ(filmCsvHeader(), "frame,id,x_cm,y_cm,theta_rad,u,v,confidence,t_s\n");
  EXPECT_EQ(filmCsvLine(row),
            "12,3,12.345679,-1.000000,-3.14159265,640.12500,360.50000,0.9700,0.400000\n");
}

}  // namespace
}  // namespace lab::tracker::film_tracking_test
