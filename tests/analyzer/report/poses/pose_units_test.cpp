#include "analyzer/report/poses/pose_units.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>
#include <span>
#include <sstream>

#include "analyzer/report/poses/pose_run.hpp"
#include "analyzer/report/summary/findings.hpp"

namespace lab::report::pose_units_test {
namespace {

using std::numbers::pi;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kPeriod = 1.0 / 20;
constexpr double kSpeed = 0.03;  // [m/s]
constexpr double kDegrees = 180 / pi;

double wrapped(double theta) { return std::remainder(theta, 2 * pi); }

/// A minute of one robot that drives along its heading.
/// @param turn [rad] in one frame
PoseFile recording(const std::function<double()>& turn, double speed = kSpeed) {
  PoseFile poses;
  poses.headings = poses.times = true;
  poses.frame_period = kPeriod;
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0, 2e-4);
  double x = 0.5;
  double y = 0.5;
  double theta = 2;
  for (std::int64_t k = 0; k < 1200; ++k) {
    const double time = static_cast<double>(k) * kPeriod;
    const Pose pose{1, true, x + noise(random), y + noise(random), theta};
    poses.add(time, k, {&pose, 1});
    x += speed * kPeriod * std::cos(theta);
    y += speed * kPeriod * std::sin(theta);
    theta += turn();
  }
  poses.rows = 1200;
  return poses;
}

/// Turns at random, as an active Brownian robot with D_r = 0.75 rad^2/s does.
PoseFile activeRecording() {
  return recording([random = std::mt19937_64(5), turn = std::normal_distribution<double>(
                                                     0, std::sqrt(2 * 0.75 * kPeriod))]() mutable {
    return turn(random);
  });
}

/// Turns so slowly that its degrees look like an unwrapped angle.
PoseFile slowRecording() {
  return recording([] { return 0.02; });
}

PoseFile with(PoseFile poses, const std::function<double(double)>& written) {
  poses.poses.each([&](Pose& pose) { pose.theta = written(pose.theta); });
  return poses;
}

PoseFile slowed(PoseFile poses, double factor) {
  for (PoseFrame& frame : poses.frames) frame.time *= factor;
  poses.frame_period *= factor;
  return poses;
}

TEST(PoseUnits, DetectDegreesByTheirSteps) {
  const auto doubts =
      unitWarnings(with(activeRecording(), [](double theta) { return wrapped(theta) * kDegrees; }));

  EXPECT_THAT(doubts, ElementsAre(AllOf(HasSubstr("headings cannot be radians"),
                                        HasSubstr("they are in degrees"))));
}

TEST(PoseUnits, DetectSlowlyTurningDegreesByTheMotion) {
  const auto unwrapped =
      unitWarnings(with(slowRecording(), [](double theta) { return theta * kDegrees; }));
  const auto backwards = unitWarnings(
      with(slowRecording(), [](double theta) { return wrapped(theta + pi) * kDegrees; }));

  EXPECT_THAT(unwrapped, ElementsAre(HasSubstr("the motion is along theta pi / 180")));
  EXPECT_THAT(backwards, ElementsAre(HasSubstr("the motion is along theta pi / 180")));
}

TEST(PoseUnits, AcceptRadians) {
  const auto same = [](double theta) { return theta; };
  const auto positive = [](double theta) { return wrapped(theta) + pi; };
  for (const auto& written :
       {std::function<double(double)>(same), std::function<double(double)>(wrapped),
        std::function<double(double)>(positive)}) {
    EXPECT_THAT(unitWarnings(with(activeRecording(), written)), IsEmpty());
    EXPECT_THAT(unitWarnings(with(slowRecording(), written)), IsEmpty());
    EXPECT_THAT(unitWarnings(with(recording([] { return 1.0; }), written)), IsEmpty())
        << "spins fast";
    EXPECT_THAT(unitWarnings(with(recording([] { return 0.3; }, 0), written)), IsEmpty())
        << "on the spot";
  }
}

TEST(PoseUnits, AcceptRecordingsWithoutHeadings) {
  PoseFile poses = with(activeRecording(), [](double theta) { return theta * kDegrees; });
  poses.headings = false;

  EXPECT_THAT(unitWarnings(poses), IsEmpty());
}

TEST(PoseUnits, DoubtImplausibleFrameRates) {
  EXPECT_THAT(unitWarnings(slowed(slowRecording(), 1000)),
              ElementsAre(AllOf(HasSubstr("0.02 frames a second"), HasSubstr("in ms?"))));
  EXPECT_THAT(unitWarnings(slowed(slowRecording(), 1e6)), ElementsAre(HasSubstr("in us?")));
  EXPECT_THAT(unitWarnings(slowed(slowRecording(), 1.0 / 60)),
              ElementsAre(HasSubstr("in minutes")));
  EXPECT_THAT(unitWarnings(slowed(slowRecording(), 40)), IsEmpty())
      << "a picture every two seconds";
  PoseFile by_hand = slowed(slowRecording(), 1000);
  by_hand.times = false;  // --fps 0.02
  EXPECT_THAT(unitWarnings(by_hand), IsEmpty());
}

TEST(PoseUnits, DoubtsAreTheFirstHeadlines) {
  std::string text = "frame,id,x_cm,y_cm,theta_rad,t_s\n";
  const PoseFile poses = slowRecording();
  poses.eachFrame([&](const PoseFrame& frame, std::span<const Pose> robots) {
    const Pose& pose = robots.front();
    text += fmt::format("{},1,{},{},{},{}\n", frame.frame, pose.x * 100, pose.y * 100,
                        pose.theta * kDegrees, frame.time * 1000);
  });
  std::istringstream file(text);

  const std::vector<std::string> dut =
      headlines(poseRun(readPoses(file, "poses.csv"), "poses", {}));

  ASSERT_GE(dut.size(), 3U);
  EXPECT_THAT(dut[0], HasSubstr("are in degrees"));
  EXPECT_THAT(dut[1], HasSubstr("in ms?"));
}

}  // namespace
}  // namespace lab::report::pose_units_test
