#include "robot_bridge/calibration/motor_fit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "tests/robot_bridge/calibration/synthetic_motor_tracks.hpp"

namespace lab::calibration {
namespace {

using testing::HasSubstr;

const Motors kHidden{{0.94, 0.081}, {1.06, 0.067}, 0.0768};

std::vector<Segment> driven(const Motors& motors, std::uint64_t seed, const Camera& camera = {}) {
  return SyntheticRobot(motors, camera, seed).drive(calibrationPattern({}, kMaxSpeed), {});
}

/// Fitted minus true value, in standard errors.
std::array<double, 5> pulls(const MotorFit& fit, const Motors& truth) {
  return {(fit.motors.left.gain - truth.left.gain) / fit.error.left.gain,
          (fit.motors.right.gain - truth.right.gain) / fit.error.right.gain,
          (fit.motors.left.dead_band - truth.left.dead_band) / fit.error.left.dead_band,
          (fit.motors.right.dead_band - truth.right.dead_band) / fit.error.right.dead_band,
          (fit.motors.wheel_base - truth.wheel_base) / fit.error.wheel_base};
}

TEST(MotorFit, RecoversMotorParametersWithCorrectErrors) {
  constexpr int kRobots = 300;
  int within_one = 0;
  double squares = 0;
  double worst = 0;
  for (int seed = 0; seed < kRobots; ++seed) {
    Random random(static_cast<std::uint64_t>(seed), 7);
    const Motors truth{{1 + 0.05 * random.normal(), 0.1 * random.uniform()},
                       {1 + 0.05 * random.normal(), 0.1 * random.uniform()},
                       0.075 * (1 + 0.02 * random.normal())};
    const MotorFit fit = fitMotors(driven(truth, static_cast<std::uint64_t>(seed)), {}, kMaxSpeed);
    ASSERT_EQ(fit.refusal, "") << seed;
    EXPECT_EQ(fit.segments.used, fit.segments.driven);
    for (const double pull : pulls(fit, truth)) {
      worst = std::max(worst, std::fabs(pull));
      squares += pull * pull;
      within_one += std::fabs(pull) < 1 ? 1 : 0;
    }
  }
  constexpr double kPulls = 5 * kRobots;
  // Of 1500 normal pulls the largest exceeds 4.6 with probability 1/160. Their mean square is
  // 1 +- 0.08 (the pulls of one robot are correlated), and 68.3 +- 2.5 % are below 1.
  EXPECT_LT(worst, 4.6);
  EXPECT_NEAR(squares / kPulls, 1, 0.25);
  EXPECT_NEAR(within_one / kPulls, 0.683, 0.06);
  RecordProperty("worst_pull", std::to_string(worst));
  RecordProperty("mean_square_pull", std::to_string(squares / kPulls));
  RecordProperty("within_one", std::to_string(within_one / kPulls));
}

TEST(MotorFit, IsExactForATrackerWithoutNoise) {
  const MotorFit fit = fitMotors(driven(kHidden, 1, {50, {0, 0}}), {}, kMaxSpeed);
  ASSERT_EQ(fit.refusal, "");
  EXPECT_NEAR(fit.motors.left.gain, kHidden.left.gain, 1e-7);
  EXPECT_NEAR(fit.motors.right.gain, kHidden.right.gain, 1e-7);
  EXPECT_NEAR(fit.motors.left.dead_band, kHidden.left.dead_band, 1e-7);
  EXPECT_NEAR(fit.motors.right.dead_band, kHidden.right.dead_band, 1e-7);
  EXPECT_NEAR(fit.motors.wheel_base, kHidden.wheel_base, 1e-8);
}

TEST(MotorFit, FindsADeadBandAboveTheLowestSpeeds) {
  const Motors sluggish{{1, 0.35}, {0.97, 0.33}, 0.075};
  const MotorFit fit = fitMotors(driven(sluggish, 2), {}, kMaxSpeed);
  ASSERT_EQ(fit.refusal, "");
  for (const double pull : pulls(fit, sluggish)) EXPECT_LT(std::fabs(pull), 4);
}

TEST(MotorFit, DistinguishesAnOffCentreMarkerFromUnequalWheels) {
  SyntheticRobot robot(kHidden, {}, 3);
  robot.setLateral(0.003);
  const MotorFit fit = fitMotors(robot.drive(calibrationPattern({}, kMaxSpeed), {}), {}, kMaxSpeed);
  ASSERT_EQ(fit.refusal, "");
  EXPECT_NEAR(fit.lateral, 0.003, 4 * fit.lateral_error);
  for (const double pull : pulls(fit, kHidden)) EXPECT_LT(std::fabs(pull), 4);
}

TEST(MotorFit, StartsFromTheStoredCalibration) {
  const Motors stored{{1.1, 20.0 / 255}, {0.9, 30.0 / 255}, 0.07};
  const auto segments =
      SyntheticRobot(kHidden, {}, 4).drive(calibrationPattern(stored, kMaxSpeed), stored);
  const MotorFit fit = fitMotors(segments, {}, kMaxSpeed);
  ASSERT_EQ(fit.refusal, "");
  for (const double pull : pulls(fit, kHidden)) EXPECT_LT(std::fabs(pull), 4);
}

TEST(MotorFit, ExcludesCollisionsAndCountsThem) {
  auto segments = driven(kHidden, 5);
  // Half-way through the third part the robot is held.
  auto& held = segments[2].track;
  for (std::size_t i = held.size() / 2; i < held.size(); ++i) {
    held[i].theta = held[held.size() / 2].theta;
  }
  // All through the tenth it is dragged along at half its speed.
  const TrackPoint first = segments[9].track.front();
  for (TrackPoint& point : segments[9].track) {
    point.x = (point.x + first.x) / 2;
    point.y = (point.y + first.y) / 2;
    point.theta = first.theta + std::remainder(point.theta - first.theta, 2 * std::numbers::pi) / 2;
  }
  const MotorFit fit = fitMotors(segments, {}, kMaxSpeed);
  ASSERT_EQ(fit.refusal, "");
  EXPECT_EQ(fit.segments.uneven + fit.segments.outlying, 2);
  EXPECT_EQ(fit.segments.uneven, 1);
  EXPECT_EQ(fit.segments.used, fit.segments.driven - 2);
  for (const double pull : pulls(fit, kHidden)) EXPECT_LT(std::fabs(pull), 4);
}

TEST(MotorFit, RefusesARobotThatWasRarelySeen) {
  auto segments = driven(kHidden, 6);
  for (std::size_t i = 0; i < segments.size(); i += 2) {
    segments[i].track.resize(segments[i].track.size() / 3);
  }
  const MotorFit fit = fitMotors(segments, {}, kMaxSpeed);
  EXPECT_THAT(fit.refusal, HasSubstr("16 of 32 parts of the pattern are usable, 24 are needed"));
  EXPECT_THAT(fit.refusal, HasSubstr("16 not seen"));
}

TEST(MotorFit, RefusesARobotThatCollidesAllTheTime) {
  auto segments = driven(kHidden, 7);
  for (std::size_t i = 0; i < segments.size(); i += 3) {
    auto& track = segments[i].track;
    for (std::size_t k = track.size() / 2; k < track.size(); ++k)
      track[k] = track[track.size() / 2];
  }
  for (Segment& segment : segments) {
    for (std::size_t k = 0; k < segment.track.size(); ++k) {
      segment.track[k].time = static_cast<double>(k) / 50;
    }
  }
  const MotorFit fit = fitMotors(segments, {}, kMaxSpeed);
  EXPECT_THAT(fit.refusal, HasSubstr("are needed"));
  EXPECT_GE(fit.segments.uneven + fit.segments.outlying, 9);
}

TEST(MotorFit, RefusesARobotThatStands) {
  auto segments = driven({{0, 0}, {0, 0}, 0.075}, 8);
  const MotorFit fit = fitMotors(segments, {}, kMaxSpeed);
  EXPECT_NE(fit.refusal, "");
}

TEST(MotorFit, RefusesWheelsWithANonlinearResponse) {
  // The speed of each wheel is the square of its duty.
  std::vector<Segment> segments;
  Random random(9);
  for (const PatternStep& step : calibrationPattern({}, kMaxSpeed)) {
    Motors at_this_duty;
    at_this_duty.left.gain = std::fabs(step.left) / kMaxSpeed;
    at_this_duty.right.gain = std::fabs(step.right) / kMaxSpeed;
    segments.push_back(SyntheticRobot(at_this_duty, {}, random.next()).drive(step, {}));
  }
  const MotorFit fit = fitMotors(segments, {}, kMaxSpeed);
  EXPECT_THAT(fit.refusal, HasSubstr("differ from the fitted ones"));
}

TEST(MotorFit, RefusesATrackerThatIsTooInaccurate) {
  const MotorFit fit = fitMotors(driven(kHidden, 10, {50, {0.01, 0.2}}), {}, kMaxSpeed);
  EXPECT_THAT(fit.refusal, HasSubstr("not known well enough"));
}

TEST(MotorFit, RefusesANominalSpeedThatIsFarOff) {
  const MotorFit fit = fitMotors(driven({{0.4, 0}, {0.41, 0}, 0.075}, 11), {}, kMaxSpeed);
  EXPECT_THAT(fit.refusal, HasSubstr("max_wheel_speed_cm_s"));
}

TEST(MotorFit, TheStoredCalibrationIsAccurateToHalfAPercent) {
  double worst = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Random random(seed, 8);
    const Motors truth{{1 + 0.05 * random.normal(), 0.15 * random.uniform()},
                       {1 + 0.05 * random.normal(), 0.15 * random.uniform()},
                       0.075 * (1 + 0.02 * random.normal())};
    SyntheticRobot robot(truth, {}, seed);
    const auto segments = robot.drive(calibrationPattern({}, kMaxSpeed), {});
    const MotorFit fit = fitMotors(segments, {}, kMaxSpeed);
    ASSERT_EQ(fit.refusal, "");
    const Motors stored = fitStorable(fit, segments, kMaxSpeed);
    EXPECT_EQ(stored, storable(stored));
    const SpeedCheck before = checkSpeeds(robot.check({}), {}, kMaxSpeed, fit.lateral);
    const SpeedCheck after = checkSpeeds(robot.check(stored), stored, kMaxSpeed, fit.lateral);
    EXPECT_LT(after.motors_speed, 0.005) << seed;
    EXPECT_LT(after.motors_turn, 0.005 + 4 * after.turn_noise / std::sqrt(6)) << seed;
    EXPECT_LT(after.speed, before.speed);
    worst = std::max({worst, after.motors_speed});
  }
  RecordProperty("worst_speed_error", std::to_string(worst));
}

}  // namespace
}  // namespace lab::calibration
