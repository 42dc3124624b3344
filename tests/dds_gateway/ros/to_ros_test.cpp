#include "dds_gateway/ros/to_ros.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

namespace lab::gateway {
namespace {

using std::numbers::pi;

tracked_pose_t poseAt(double x, double y, double theta) {
  tracked_pose_t pose{};
  pose.robot_id = 7;
  pose.x = x;
  pose.y = y;
  pose.theta = theta;
  for (int i = 0; i < 6; ++i) pose.covariance[i] = i + 1;
  return pose;
}

TEST(ToRos, StampsAreExact) {
  const auto is = [](std::int64_t utime, std::int32_t sec, std::uint32_t nanosec) {
    const ros::Time time = stampOf(utime);
    EXPECT_EQ(time.sec, sec) << utime;
    EXPECT_EQ(time.nanosec, nanosec) << utime;
  };
  is(0, 0, 0);
  is(1'700'000'000'123'456, 1'700'000'000, 123'456'000);
  is(999'999, 0, 999'999'000);
  is(-1, -1, 999'999'000);
  is(-1'000'000, -1, 0);
}

TEST(ToRos, YawTurnsAboutZ) {
  for (const double theta : {0.0, 0.3, pi / 2, -pi / 2, 3.1, -3.1, pi}) {
    const ros::Quaternion q = yaw(theta);
    EXPECT_EQ(q.x, 0);
    EXPECT_EQ(q.y, 0);
    EXPECT_NEAR(q.z * q.z + q.w * q.w, 1, 1e-15);
    // The rotated x axis, by REP-103's formula of yaw.
    EXPECT_NEAR(1 - 2 * q.z * q.z, std::cos(theta), 1e-15);
    EXPECT_NEAR(2 * q.w * q.z, std::sin(theta), 1e-15);
    EXPECT_GE(q.w, 0);
  }
}

TEST(ToRos, CovarianceIsWhereRosReadsIt) {
  ros::Odometry message{};
  setCovariance(poseAt(0, 0, 0), message.pose.covariance);
  const auto& c = message.pose.covariance;
  // ROS 2: row-major over x, y, z, roll, pitch, yaw. The lab: xx, xy, xt, yy, yt, tt.
  const std::map<int, double> expected{{0, 1}, {1, 2},  {6, 2},  {5, 3}, {30, 3},
                                       {7, 4}, {11, 5}, {31, 5}, {35, 6}};
  for (int i = 0; i < 36; ++i) {
    const auto entry = expected.find(i);
    EXPECT_EQ(c[i], entry == expected.end() ? 0 : entry->second) << i;
  }
}

TEST(ToRos, MotionIsTheInverseOfTheWheels) {
  const Motion dut = motionOf(0.1, 0.25, 0.075);
  EXPECT_DOUBLE_EQ(dut.forward, 0.175);
  EXPECT_DOUBLE_EQ(dut.turn, 2);
}

TEST(ToRos, FramesFollowRep105) {
  const RobotMessages dut("lab/arena", "lab/robot7");
  const tracked_pose_t pose = poseAt(0.3, 0.4, 1);
  const ros::PoseStamped stamped = dut.pose(1'500'000, pose);
  EXPECT_STREQ(stamped.header.frame_id, "lab/arena");
  EXPECT_EQ(stamped.header.stamp.sec, 1);
  EXPECT_EQ(stamped.pose.position.x, 0.3);
  EXPECT_EQ(stamped.pose.position.y, 0.4);
  EXPECT_EQ(stamped.pose.position.z, 0);

  const Motion motion{0.1, -2};
  const ros::Odometry odometry = dut.odometry(0, pose, &motion);
  EXPECT_STREQ(odometry.header.frame_id, "lab/arena");
  EXPECT_STREQ(odometry.child_frame_id, "lab/robot7");
  EXPECT_EQ(odometry.twist.twist.linear.x, 0.1);
  EXPECT_EQ(odometry.twist.twist.angular.z, -2);
  EXPECT_EQ(odometry.twist.covariance[0], 0);
  EXPECT_EQ(dut.odometry(0, pose, nullptr).twist.covariance[0], kUnknownVariance);
  EXPECT_EQ(dut.odometry(0, pose, nullptr).twist.covariance[35], kUnknownVariance);

  const ros::TransformStamped transform = dut.transform(0, pose);
  EXPECT_STREQ(transform.header.frame_id, "lab/arena");
  EXPECT_STREQ(transform.child_frame_id, "lab/robot7");
  EXPECT_EQ(transform.transform.translation.x, 0.3);
}

TEST(ToRos, LightIsTheReadingThatSelectsPrograms) {
  const RobotMessages dut("lab/arena", "lab/robot7");
  robot_state_t state{};
  state.utime = 2'000'000;
  state.light_front = 0.25F;
  state.light_back = 0.75F;
  EXPECT_EQ(dut.light(state, LightSensor::kMean).illuminance, 0.5);
  EXPECT_EQ(dut.light(state, LightSensor::kFront).illuminance, 0.25);
  EXPECT_EQ(dut.light(state, LightSensor::kBack).illuminance, 0.75);
  EXPECT_STREQ(dut.light(state, LightSensor::kBack).header.frame_id, "lab/robot7");
}

light::Field halfLit() {
  light::Layer half;
  half.kind = light::LayerKind::kHalfPlane;
  half.x = 0.6;
  half.y = 0.45;
  half.angle = 0;
  half.intensity = 1;
  light::Field field;
  field.layers = {half};
  return field;
}

TEST(ToRos, TheLightFieldIsAMap) {
  LightGrid dut(1.2, 0.9, "lab/arena");
  const light::Field field = halfLit();
  const light::CompiledField compiled(field);
  const ros::OccupancyGrid& grid = dut.paint(compiled, 3'000'000, 1'000'000);
  EXPECT_EQ(grid.info.width, 120U);
  EXPECT_EQ(grid.info.height, 90U);
  EXPECT_FLOAT_EQ(grid.info.resolution, 0.01F);
  EXPECT_EQ(grid.info.map_load_time.sec, 1);
  EXPECT_EQ(grid.info.origin.orientation.w, 1);
  ASSERT_EQ(grid.data._length, 120U * 90U);
  for (std::uint32_t j = 0; j < grid.info.height; ++j) {
    for (std::uint32_t i = 0; i < grid.info.width; ++i) {
      const double light = compiled.evaluate((i + 0.5) * 0.01, (j + 0.5) * 0.01);
      ASSERT_EQ(grid.data._buffer[j * 120 + i], std::lround(100 * light)) << i << " " << j;
    }
  }
  EXPECT_NE(grid.data._buffer[0], grid.data._buffer[119]);
}

TEST(ToRos, ALargeArenaHasLargerCells) {
  LightGrid dut(8, 3, "a");
  const ros::OccupancyGrid& grid = dut.paint(light::CompiledField(), 0, 0);
  EXPECT_EQ(grid.info.width, 160U);
  EXPECT_EQ(grid.info.height, 60U);
  EXPECT_FLOAT_EQ(grid.info.resolution, 0.05F);
}

TEST(ToRos, AnalysisKeepsEveryNumber) {
  analysis_t source{};
  source.utime = 5'000'000;
  source.robot_id = analysis_t::POOL;
  source.program.name = "abp";
  source.program.hash = 0xFEDC'BA98;
  source.verdict = analysis_t::AGREES;
  source.max_z = 2.5;
  curve_t curve{};
  curve.name = "msd";
  curve.lag = {0.1F, 0.2F};
  curve.windows = {10, 5};
  curve.biased = {0, 1};
  curve.num_lags = 2;
  source.curves = {curve};
  estimate_t estimate{};
  estimate.name = "D_r";
  estimate.value = std::nan("");
  source.estimates = {estimate, estimate};

  AnalysisMessage dut("lab/arena");
  const ros::Analysis& message = dut.make(source, "law = \"abp\"\n");
  EXPECT_EQ(message.robot_id, -1);
  EXPECT_STREQ(message.program_name, "abp");
  EXPECT_EQ(message.program.hash, 0xFEDC'BA98U);
  EXPECT_STREQ(message.program.text, "law = \"abp\"\n");
  EXPECT_EQ(message.verdict, 1);
  EXPECT_EQ(message.max_z, 2.5);
  ASSERT_EQ(message.curves._length, 1U);
  EXPECT_STREQ(message.curves._buffer[0].name, "msd");
  ASSERT_EQ(message.curves._buffer[0].lag._length, 2U);
  EXPECT_EQ(message.curves._buffer[0].lag._buffer[1], 0.2F);
  EXPECT_EQ(message.curves._buffer[0].windows._buffer[0], 10);
  EXPECT_FALSE(message.curves._buffer[0].biased._buffer[0]);
  EXPECT_TRUE(message.curves._buffer[0].biased._buffer[1]);
  ASSERT_EQ(message.estimates._length, 2U);
  EXPECT_STREQ(message.estimates._buffer[1].name, "D_r");
  EXPECT_STREQ(message.estimates._buffer[1].note, "");
  EXPECT_TRUE(std::isnan(message.estimates._buffer[0].value));
}

TEST(ToRos, DiagnosticsPointAtTheirTexts) {
  Diagnostics dut;
  dut.add({Diagnostics::kWarn, "lab: a", "lost", "host", {{"k", "v"}, {"k2", "v2"}}});
  dut.add({Diagnostics::kOk, "lab: b", "", "", {}});
  const ros::DiagnosticArray& message = dut.make(0);
  ASSERT_EQ(message.status._length, 2U);
  EXPECT_EQ(message.status._buffer[0].level, 1);
  EXPECT_STREQ(message.status._buffer[0].hardware_id, "host");
  ASSERT_EQ(message.status._buffer[0].values._length, 2U);
  EXPECT_STREQ(message.status._buffer[0].values._buffer[1].value, "v2");
  EXPECT_STREQ(message.status._buffer[1].name, "lab: b");
  EXPECT_EQ(message.status._buffer[1].values._length, 0U);
}

TEST(ToRos, ReceivedTextsBecomeValidUtf8) {
  Diagnostics diagnostics;
  diagnostics.add({Diagnostics::kOk, "a\xFF", "b\xFF", "c\xFF", {{"d\xFF", "e\xFF"}}});
  const ros::DiagnosticStatus& status = diagnostics.make(0).status._buffer[0];
  EXPECT_STREQ(status.name, "a\uFFFD");
  EXPECT_STREQ(status.message, "b\uFFFD");
  EXPECT_STREQ(status.hardware_id, "c\uFFFD");
  EXPECT_STREQ(status.values._buffer[0].key, "d\uFFFD");
  EXPECT_STREQ(status.values._buffer[0].value, "e\uFFFD");

  analysis_t source{};
  source.program.name = "a\xFF";
  source.curves.resize(1);
  source.curves[0].name = "b\xFF";
  source.curves[0].unit = "c\xFF";
  source.estimates.resize(1);
  source.estimates[0].name = "d\xFF";
  source.estimates[0].unit = "e\xFF";
  source.estimates[0].note = "f\xFF";
  AnalysisMessage maker("lab/arena");
  const ros::Analysis& message = maker.make(source, "g\xFF");
  EXPECT_STREQ(message.program_name, "a\uFFFD");
  EXPECT_STREQ(message.program.text, "g\uFFFD");
  EXPECT_STREQ(message.curves._buffer[0].name, "b\uFFFD");
  EXPECT_STREQ(message.curves._buffer[0].unit, "c\uFFFD");
  EXPECT_STREQ(message.estimates._buffer[0].name, "d\uFFFD");
  EXPECT_STREQ(message.estimates._buffer[0].unit, "e\uFFFD");
  EXPECT_STREQ(message.estimates._buffer[0].note, "f\uFFFD");
}

}  // namespace
}  // namespace lab::gateway
