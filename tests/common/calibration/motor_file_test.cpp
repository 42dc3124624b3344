#include "common/calibration/motor_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "common/experiment/experiment_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab {
namespace {

using testing::HasSubstr;

constexpr const char* kRobot = R"(
[[robots]]
id = 3
gain_left = 0.95
gain_right = 1.05
dead_band_left_percent = 8
dead_band_right_percent = 0
wheel_base_cm = 7.6
gain_left_error = 0.001
)";

class MotorFile : public testing::Test {
 protected:
  MotorCalibrations read(const std::string& text) {
    const auto file = folder_ / "motors.toml";
    std::ofstream(file) << text;
    return readMotorFile(file);
  }

  std::string refusal(const std::string& text) {
    try {
      static_cast<void>(read(text));
    } catch (const ExperimentError& error) {
      return error.what();
    }
    return "";
  }

  static std::string with(std::string text, const std::string& old, const std::string& now) {
    return text.replace(text.find(old), old.size(), now);
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(MotorFile, IsRead) {
  const MotorCalibrations motors = read(kRobot);
  ASSERT_EQ(motors.size(), 1U);
  const motor_calibration_t& robot = motors.at(3);
  EXPECT_EQ(robot.robot_id, 3);
  EXPECT_EQ(robot.gain_left, 0.95);
  EXPECT_EQ(robot.gain_right, 1.05);
  EXPECT_DOUBLE_EQ(robot.dead_band_left, 0.08);
  EXPECT_EQ(robot.dead_band_right, 0);
  EXPECT_DOUBLE_EQ(robot.wheel_base, 0.076);
}

TEST_F(MotorFile, IsRefusedWithRobotAndKey) {
  EXPECT_THAT(refusal(with(kRobot, "gain_left = 0.95", "gain_left = 3")),
              HasSubstr("robot 3: gain_left: found 3, allowed 0.5 to 1.5"));
  EXPECT_THAT(refusal(with(kRobot, "gain_right = 1.05", "gain_right = nan")),
              HasSubstr("gain_right: found nan"));
  EXPECT_THAT(refusal(with(kRobot, "wheel_base_cm = 7.6", "")),
              HasSubstr("wheel_base_cm: found no number"));
  EXPECT_THAT(refusal(std::string(kRobot) + kRobot), HasSubstr("robot 3 occurs twice"));
  // Numbers that no integer can hold are not converted to one.
  for (const char* id : {"id = 6.3e88", "id = 3.5", "id = \"3\"", "id = nan", ""}) {
    EXPECT_THAT(refusal(with(kRobot, "id = 3", id)), HasSubstr("id: found no whole number")) << id;
  }
  EXPECT_THAT(refusal("x = 1"), HasSubstr("found no [[robots]]"));
  EXPECT_THAT(refusal("x = = 1"), HasSubstr("line 1"));
}

TEST_F(MotorFile, ReportsAMissingFile) {
  EXPECT_THROW(static_cast<void>(readMotorFile("nowhere/motors.toml")), ExperimentError);
}

}  // namespace
}  // namespace lab
