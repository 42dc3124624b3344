#include "tracker_svc/calibration/spacing_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>

#include "common/math/random.hpp"

namespace lab::calibration {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kSpacing = 0.036;
constexpr double kSigma = 20e-6;

/// Relative error of a spacing [1], by time and place relative to the middle of the arena.
using Error = std::function<double(double, double, double)>;

/// Robots that wander in an arena of 120 x 90 cm, with slightly different caps.
class Wanderers {
 public:
  Wanderers(int robots, double cap_error, std::uint64_t seed) : random_(seed, 1) {
    for (int i = 0; i < robots; ++i) {
      robots_.push_back({1.2 * random_.uniform(), 0.9 * random_.uniform(),
                         2 * std::numbers::pi * random_.uniform(), cap_error * random_.normal()});
    }
  }

  void film(SpacingCheck& check, double begin, double end, double interval, const Error& error) {
    for (double time = begin; time < end; time += interval) {
      for (Robot& robot : robots_) {
        robot.heading += 0.8 * std::sqrt(interval) * random_.normal();
        robot.x = bounce(robot.x + 0.05 * interval * std::cos(robot.heading), 1.2, robot);
        robot.y = bounce(robot.y + 0.05 * interval * std::sin(robot.heading), 0.9, robot);
        const double measured = kSpacing * (1 + error(time, robot.x - 0.6, robot.y - 0.45)) +
                                robot.cap_error + kSigma * random_.normal();
        check.add(time, robot.x, robot.y, measured, kSigma);
      }
    }
  }

 private:
  struct Robot {
    double x, y, heading, cap_error;
  };

  double bounce(double at, double length, Robot& robot) {
    if (at >= 0 && at <= length) return at;
    robot.heading = 2 * std::numbers::pi * random_.uniform();
    return std::clamp(at, 0.0, length);
  }

  Random random_;
  std::vector<Robot> robots_;
};

double none(double, double, double) { return 0; }

TEST(SpacingCheck, ReportsNothingForAStillCamera) {
  SpacingCheck check;
  Wanderers(20, 0, 1).film(check, 0, 60, 0.1, none);
  const SpacingReport report = check.report(60);
  EXPECT_TRUE(report.known);
  EXPECT_FALSE(report.moved);
  EXPECT_TRUE(report.fits);
  EXPECT_THAT(report.text, IsEmpty());
  EXPECT_LT(std::abs(report.mean_error), 4 * report.sigma);
  EXPECT_GT(report.sigma, 0);
  EXPECT_LT(report.sigma, 5e-6);
}

TEST(SpacingCheck, HasNoResultWithoutCaps) {
  SpacingCheck check;
  EXPECT_FALSE(check.report(100).known);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (double time = 0; time < 20; time += 1) {
    check.add(time, kNan, 0, kSpacing, kSigma);
    check.add(time, 0, 0, kSpacing, 0);
    check.add(time, 0, 0, kNan, kSigma);
    check.add(time, 0, 0, 0, kSigma);
  }
  EXPECT_FALSE(check.report(100).known);
  EXPECT_THAT(check.report(100).text, IsEmpty());
}

TEST(SpacingCheck, GivesNoFalseAlarmForDays) {
  // Three days of 20 robots with different caps: at most three alarms at one per day; the specified
  // rate is far lower.
  SpacingCheck check;
  Wanderers robots(20, 30e-6, 2);
  int alarms = 0;
  bool before = false;
  for (double time = 0; time < 3 * 86400.0; time += 5) {
    robots.film(check, time, time + 5, 1, none);
    const SpacingReport report = check.report(time + 5);
    alarms += report.moved && !before ? 1 : 0;
    before = report.moved;
    ASSERT_TRUE(report.fits) << report.text;
  }
  EXPECT_EQ(alarms, 0);
}

TEST(SpacingCheck, DetectsACameraThatSinksByThreeMillimetres) {
  const Error sinks = [](double time, double, double) { return time < 120 ? 0 : 0.003 / 1.67; };
  SpacingCheck check;
  Wanderers robots(20, 10e-6, 3);
  robots.film(check, 0, 120, 0.1, sinks);
  EXPECT_FALSE(check.report(120).moved);
  robots.film(check, 120, 140, 0.1, sinks);
  const SpacingReport report = check.report(140);
  EXPECT_TRUE(report.moved);
  EXPECT_NEAR(report.scale, 0.003 / 1.67, 0.0005);
  EXPECT_NEAR(report.shift, 0.433 * 0.003 / 1.67, 0.6e-3);
  EXPECT_THAT(report.text, HasSubstr("the camera has moved since the start"));
}

TEST(SpacingCheck, DetectsACameraThatTiltsByATenthOfADegree) {
  constexpr double kTilt = 0.1 * std::numbers::pi / 180;
  const Error tilts = [](double time, double x, double) {
    return time < 120 ? 0 : 1.5 * kTilt / 1.67 * x;
  };
  SpacingCheck check;
  Wanderers robots(20, 10e-6, 4);
  robots.film(check, 0, 120, 0.1, tilts);
  EXPECT_FALSE(check.report(120).moved);
  robots.film(check, 120, 140, 0.1, tilts);
  const SpacingReport report = check.report(140);
  EXPECT_TRUE(report.moved);
  EXPECT_NEAR(report.shift, 1.67 * kTilt, 1e-3);
}

TEST(SpacingCheck, DetectsACalibrationThatNeverFitted) {
  SpacingCheck check;
  const Error off = [](double, double, double) { return 0.006; };
  Wanderers(5, 0, 5).film(check, 0, 30, 0.1, off);
  const SpacingReport report = check.report(30);
  EXPECT_FALSE(report.moved);
  EXPECT_FALSE(report.fits);
  EXPECT_NEAR(report.position_error, 0.433 * 0.006, 1e-3);
  EXPECT_THAT(report.text, HasSubstr("the calibration does not fit"));
}

TEST(SpacingCheck, ReportsBeforeTheFirstWindowIsComplete) {
  SpacingCheck check;
  const Error off = [](double, double, double) { return 0.002; };
  Wanderers(5, 0, 6).film(check, 0, 2, 0.1, off);
  const SpacingReport report = check.report(2);
  EXPECT_NEAR(report.scale, 0.002, 0.001);
  EXPECT_FALSE(report.moved);
  EXPECT_TRUE(report.fits);
}

/// A recording of resting robots at different places, whose errors are constant over time.
SpacingReport filmOf(int robots, const Error& error, double stays, double sigma) {
  SpacingSettings settings;
  settings.window = std::numeric_limits<double>::infinity();
  SpacingCheck check(settings);
  Random random(7, 1);
  for (int i = 0; i < robots; ++i) {
    const double x = 0.1 + 0.2 * (i % 6);
    const double y = 0.1 + 0.2 * (i / 6);
    const double its = stays * random.normal();
    for (int k = 0; k < 30; ++k) {
      check.add(k / 30.0, x, y, kSpacing * (1 + error(0, x - 0.6, y - 0.45)) + its, sigma);
    }
  }
  return check.whole();
}

TEST(SpacingCheck, DetectsATiltedCalibrationInAShortRecording) {
  constexpr double kTilt = 0.5 * std::numbers::pi / 180;
  const Error tilts = [](double, double, double y) { return 1.5 * kTilt / 1.67 * y; };

  const SpacingReport report = filmOf(24, tilts, 20e-6, kSigma);

  EXPECT_FALSE(report.fits);
  EXPECT_NEAR(report.position_error, 1.67 * kTilt, 2e-3);
  EXPECT_NEAR(report.slope_y, 1.5 * kTilt / 1.67, 1e-3);
  EXPECT_LT(std::abs(report.scale), 1e-3) << "the mean says nothing";
  EXPECT_THAT(report.text, HasSubstr("the calibration does not fit"));
}

TEST(SpacingCheck, DoesNotMistakeCodecArtefactsForTilt) {
  const SpacingReport report = filmOf(24, none, 0.2e-3, kSigma);

  EXPECT_TRUE(report.known);
  EXPECT_TRUE(report.fits) << report.text;
  EXPECT_THAT(report.text, IsEmpty());
}

TEST(SpacingCheck, HasNoResultFromThreePlaces) {
  const Error off = [](double, double x, double) { return 0.1 * x; };
  EXPECT_FALSE(filmOf(3, off, 0, kSigma).known);
  EXPECT_TRUE(filmOf(3, off, 0, kSigma).fits);
}

}  // namespace
}  // namespace lab::calibration
