#include "runner/calibrate/pattern_driver.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "common/math/units.hpp"
#include "robot/dynamics/kinematics.hpp"

namespace lab::runner {
namespace {

using calibration::Motors;
using testing::HasSubstr;

constexpr std::int64_t kTick_us = 20'000;
constexpr double kMax = 0.27;

/// A robot that echoes commands after a delay, and a camera without noise.
class Bench {
 public:
  explicit Bench(const Motors& motors = {}, double x = 0.6, double y = 0.45, double theta = 0.3)
      : motors_(motors), pose_{x, y, theta} {
    experiment_.camera.delay = 0.02;
    driver_.emplace(
        experiment_, 7, Motors{}, calibration::checkPattern(kMax), seen_robots_,
        DriveActions{[this](double left, double right) { drive(left, right); },
                     [this] { drive(0, 0); },
                     [this] { return answers_ && now_ - commanded_utime_ > kEcho_us; }});
  }

  void run(double seconds) {
    for (const std::int64_t end = now_ + units::microseconds(seconds);
         now_ < end && !driver_->isOver(); now_ += kTick_us) {
      move();
      if (seen_) show();
      driver_->tick(now_);
    }
  }

  void put(std::int32_t id, double x, double y) { seen_robots_[id] = {0, {x, y, 0}}; }
  void hide() { seen_ = false; }
  void fallSilent() { answers_ = false; }
  void report(std::int32_t flags) {
    robot_state_t state{};
    state.robot_id = 7;
    state.flags = flags;
    driver_->hear(state);
  }
  [[nodiscard]] const PatternDriver& driver() const { return *driver_; }
  [[nodiscard]] const dynamics::Pose& pose() const { return pose_; }
  [[nodiscard]] double clearance() const { return clearance_; }
  [[nodiscard]] bool stands() const { return left_ == 0 && right_ == 0; }

 private:
  static constexpr std::int64_t kEcho_us = 50'000;

  void drive(double left, double right) {
    left_ = calibration::dutyFor({}, left, kMax, true);
    right_ = calibration::dutyFor({}, right, kMax, true);
    commanded_utime_ = now_;
  }
  void move() {
    const double left = calibration::wheelSpeed(motors_.left, left_, kMax);
    const double right = calibration::wheelSpeed(motors_.right, right_, kMax);
    pose_ = dynamics::apply(
        dynamics::makeArc(left, right, motors_.wheel_base, units::seconds(kTick_us)), pose_);
    clearance_ = std::min({clearance_, pose_.x, pose_.y, 1.2 - pose_.x, 0.9 - pose_.y});
  }
  void show() {
    tracked_frame_t frame{};
    frame.utime = now_;
    tracked_pose_t pose{};
    pose.robot_id = 7;
    pose.x = pose_.x;
    pose.y = pose_.y;
    pose.theta = std::remainder(pose_.theta, 2 * M_PI);
    frame.robots.push_back(pose);
    frame.num_robots = 1;
    seen_robots_[7] = {now_, {pose.x, pose.y, pose.theta}};
    driver_->see(frame);
  }

  Experiment experiment_;
  Motors motors_;
  dynamics::Pose pose_;
  double clearance_ = 1;
  SeenRobots seen_robots_;
  std::int64_t now_ = 1'000'000;
  std::int64_t commanded_utime_ = 0;
  double left_ = 0;
  double right_ = 0;
  bool seen_ = true;
  bool answers_ = true;
  std::optional<PatternDriver> driver_;
};

TEST(PatternDriver, DrivesEveryStepAndRecordsThePoses) {
  Bench bench;
  bench.run(60);
  ASSERT_TRUE(bench.driver().isOver());
  EXPECT_EQ(bench.driver().failure(), "");
  EXPECT_TRUE(bench.stands());
  const auto pattern = calibration::checkPattern(kMax);
  const auto segments = bench.driver().segments();
  ASSERT_EQ(segments.size(), pattern.size());
  for (std::size_t i = 0; i < segments.size(); ++i) {
    EXPECT_EQ(segments[i].left, pattern[i].left);
    EXPECT_EQ(segments[i].segment.duty_right,
              calibration::dutyFor({}, pattern[i].right, kMax, true));
    EXPECT_NEAR(segments[i].segment.frames, pattern[i].duration * 50, 2);
    EXPECT_NEAR(static_cast<double>(segments[i].segment.track.size()), pattern[i].duration * 50, 3);
  }
  const auto check = calibration::checkSpeeds(segments, {}, kMax, 0);
  EXPECT_EQ(check.used, check.driven);
  EXPECT_LT(check.motors_speed, 1e-6);
  EXPECT_LT(check.motors_turn, 1e-6);
}

TEST(PatternDriver, TurnsAwayFromAWallFirst) {
  Bench bench({}, 1.12, 0.45, 0);
  bench.run(60);
  EXPECT_EQ(bench.driver().failure(), "");
  EXPECT_EQ(bench.driver().segments().size(), 12U);
  EXPECT_GT(bench.clearance(), 0.0375);
}

TEST(PatternDriver, LeavesAWallThatIsTooNear) {
  Bench bench({}, 0.41, 0.86, 2.0);
  bench.run(60);
  EXPECT_EQ(bench.driver().failure(), "");
  EXPECT_EQ(bench.driver().segments().size(), 12U);
  EXPECT_GT(bench.clearance(), 0.0375);
  EXPECT_LT(bench.pose().y, 0.845);
}

TEST(PatternDriver, RaisesTheSpeedOfWheelsThatDoNotTurnYet) {
  Bench bench({{1, 0.4}, {1, 0.4}, 0.075}, 1.12, 0.45, 0);
  bench.run(60);
  EXPECT_EQ(bench.driver().failure(), "");
}

TEST(PatternDriver, ReportsThatMotorsAreOff) {
  Bench bench({{0, 0}, {0, 0}, 0.075}, 1.12, 0.45, 0);
  bench.run(60);
  EXPECT_THAT(bench.driver().failure(), HasSubstr("robot 7 does not turn as commanded"));
  EXPECT_TRUE(bench.stands());
}

TEST(PatternDriver, ReportsThatThereIsNoRoom) {
  Bench bench;
  for (int i = 0; i < 6; ++i) {
    bench.put(10 + i, 0.6 + 0.09 * std::cos(i * M_PI / 3), 0.45 + 0.09 * std::sin(i * M_PI / 3));
  }
  bench.run(60);
  EXPECT_THAT(bench.driver().failure(), HasSubstr("robot 7 has no room at (60, 45) cm"));
  EXPECT_THAT(bench.driver().failure(), HasSubstr("is 9 cm away"));
}

TEST(PatternDriver, ReportsThatTheRobotIsNotSeen) {
  Bench bench;
  bench.hide();
  bench.run(60);
  EXPECT_THAT(bench.driver().failure(), HasSubstr("robot 7 is not seen by the tracker"));
}

TEST(PatternDriver, ReportsThatTheRobotDoesNotAnswer) {
  Bench bench;
  bench.run(3);
  bench.fallSilent();
  bench.run(60);
  EXPECT_THAT(bench.driver().failure(), HasSubstr("robot 7 does not answer"));
  EXPECT_TRUE(bench.stands());
}

TEST(PatternDriver, EndsWhenTheRobotIsStopped) {
  Bench bench;
  bench.run(3);
  bench.report(robot_state_t::FLAG_STOPPED);
  EXPECT_TRUE(bench.driver().isOver());
  EXPECT_THAT(bench.driver().failure(), HasSubstr("lab stop --clear"));
}

}  // namespace
}  // namespace lab::runner
