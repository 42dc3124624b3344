#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "common/math/random.hpp"
#include "tests/support/lab_process.hpp"

namespace lab::system_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr const char* kThreeRobots = R"(
fileversion = 1
name = "three"
seed = 5
duration_s = 60
program = "abp"
[[robots]]
id = 1
x_cm = 30
y_cm = 45
theta_deg = 0
[[robots]]
id = 2
x_cm = 60
y_cm = 45
theta_deg = 100
[[robots]]
id = 3
x_cm = 114
y_cm = 45
theta_deg = 10
[programs.abp]
model = "abp"
v_cm_s = 3
epsilon_s = 0.5
eta_rad_s = 3
[robot]
wheel_gain_error_percent = 5
wheel_base_error_percent = 2
motor_dead_band_percent = 8
[camera]
fps = 50
position_noise_cm = 0.03
heading_noise_deg = 0.6
)";

class CalibrateMotors : public testing::Test {
 protected:
  CalibrateMotors() { std::ofstream(file()) << kThreeRobots; }

  [[nodiscard]] fs::path file() const { return folder_.path() / "three.toml"; }

  Finished calibrate(const std::string& more) {
    out_ = folder_.path() / std::to_string(++runs_);
    return run("lab calibrate motors " + file().string() + " --virtual-time --out " +
               out_.string() + " " + more);
  }

  [[nodiscard]] toml::table motors() const {
    return toml::parse_file((onlyRun(out_) / "calibration" / "motors.toml").string());
  }

  [[nodiscard]] const fs::path& out() const { return out_; }

 private:
  TemporaryFolder folder_;
  fs::path out_;
  int runs_ = 0;
};

double number(const toml::table& table, const char* key) {
  return table[key].value<double>().value();
}

/// The true parameters of a simulated robot, from the same draws as in World::addRobot.
struct TrueMotors {
  double gain_left, gain_right, wheel_base_cm;
};

TrueMotors trueMotorsOf(std::int64_t robot, std::uint64_t seed) {
  const auto factor = [](Random& random, double error) { return 1 + error * random.normal(); };
  Random wheels(deriveSeed(seed, robot, "wheels"));
  Random base(deriveSeed(seed, robot, "wheel base"));
  const double left = factor(wheels, 0.05);
  const double right = factor(wheels, 0.05);
  return {left, right, 7.5 * factor(base, 0.02)};
}

void expectCalibrated(const toml::table& file) {
  const toml::array& robots = *file["robots"].as_array();
  ASSERT_EQ(robots.size(), 3U);
  for (const toml::node& node : robots) {
    const toml::table& robot = *node.as_table();
    const auto id = robot["id"].value<std::int64_t>().value();
    const TrueMotors truth = trueMotorsOf(id, 5);
    const auto pull = [&](const std::string& key, double expected) {
      return std::fabs(number(robot, (key + "_fitted").c_str()) - expected) /
             number(robot, (key + "_error").c_str());
    };
    EXPECT_LT(pull("gain_left", truth.gain_left), 4) << id;
    EXPECT_LT(pull("gain_right", truth.gain_right), 4) << id;
    EXPECT_LT(pull("wheel_base_cm", truth.wheel_base_cm), 4) << id;
    EXPECT_LT(pull("dead_band_left_percent", 8), 4) << id;
    EXPECT_LT(pull("dead_band_right_percent", 8), 4) << id;
    // A robot stores whole duty cycles: 20 or 21 of 255.
    const double duty = number(robot, "dead_band_left_percent") * 2.55;
    EXPECT_NEAR(duty, std::round(duty), 1e-3);

    const toml::table& before = *robot["check_before"].as_table();
    const toml::table& after = *robot["check_after"].as_table();
    EXPECT_EQ(after["parts"].value<std::int64_t>(), 12) << id;
    EXPECT_GT(number(before, "speed_error_percent"), 4) << id;
    EXPECT_LT(number(after, "speed_error_percent"), 0.8) << id;
    EXPECT_LT(number(after, "motors_speed_percent"), 0.5) << id;
    EXPECT_GT(number(before, "turn_error_percent"), 4) << id;
    EXPECT_LT(number(after, "motors_turn_percent"), 1.5) << id;
    EXPECT_LT(number(after, "veer_deg_m"), 10) << id;
  }
  EXPECT_FALSE(file.contains("refused"));
}

TEST_F(CalibrateMotors, FindsAndStoresTheTrueParameters) {
  const Finished lab = calibrate("");
  EXPECT_EQ(lab.exit_code, 0) << lab.output;
  EXPECT_THAT(lab.output, HasSubstr("robots   3"));
  expectCalibrated(motors());
}

TEST_F(CalibrateMotors, WorksOnSerialLinesAndOnALossyBus) {
  const Finished lab = calibrate(
      "--set robots[0].body=wire --set robots[2].body=wire --set faults.message_loss=0.02");
  EXPECT_EQ(lab.exit_code, 0) << lab.output;
  expectCalibrated(motors());
}

TEST_F(CalibrateMotors, WorksWithTheFirmwareOnAChip) {
  if (!fs::exists(fs::path(LAB_PROGRAMS) / "robot_emulator")) {
    GTEST_SKIP() << "built without the emulator";
  }
  const Finished lab = calibrate("--set robots[1].body=firmware");
  EXPECT_EQ(lab.exit_code, 0) << lab.output;
  expectCalibrated(motors());
}

TEST_F(CalibrateMotors, ARobotWithItsCalibrationDrivesWell) {
  ASSERT_EQ(calibrate("").exit_code, 0);
  fs::copy_file(onlyRun(out()) / "calibration" / "motors.toml", file().parent_path() / "held.toml");
  const Finished again = calibrate("--set robot.motors=held.toml --set robots[1].body=wire");
  ASSERT_EQ(again.exit_code, 0) << again.output;
  EXPECT_TRUE(fs::exists(onlyRun(out()) / "calibration" / "motors_in_force.toml"));
  const toml::table file_again = motors();
  ASSERT_EQ(file_again["robots"].as_array()->size(), 3U);
  for (const toml::node& node : *file_again["robots"].as_array()) {
    const toml::table& robot = *node.as_table();
    EXPECT_LT(number(*robot["check_before"].as_table(), "motors_speed_percent"), 0.5);
  }
}

TEST_F(CalibrateMotors, IsBitIdenticalWhenRepeated) {
  ASSERT_EQ(calibrate("--robot 2").exit_code, 0);
  const std::string once = readFile(onlyRun(out()) / "calibration" / "motors.toml");
  const std::string log = readFile(onlyRun(out()) / "log.lcmlog");
  ASSERT_EQ(calibrate("--robot 2").exit_code, 0);
  EXPECT_TRUE(once == readFile(onlyRun(out()) / "calibration" / "motors.toml"));
  EXPECT_TRUE(log == readFile(onlyRun(out()) / "log.lcmlog"));
}

TEST_F(CalibrateMotors, RefusesARobotWithoutRoomAndCalibratesTheOthers) {
  // Robot 2 is in a corner that robot 1 blocks.
  const Finished lab = calibrate(
      "--set robots[1].x_cm=5 --set robots[1].y_cm=5 --set robots[0].x_cm=12 "
      "--set robots[0].y_cm=12");
  EXPECT_EQ(lab.exit_code, 1) << lab.output;
  EXPECT_THAT(lab.output, HasSubstr("robot 2 has no room at (5, 5) cm"));
  EXPECT_THAT(lab.output, HasSubstr("robot 1 is 10 cm away"));
  const toml::table file = motors();
  ASSERT_EQ(file["refused"].as_array()->size(), 1U);
  EXPECT_EQ(file["refused"][0]["id"].value<std::int64_t>(), 2);
  EXPECT_EQ(file["robots"].as_array()->size(), 2U);
}

TEST_F(CalibrateMotors, RefusesARobotThatTheCameraRarelySees) {
  const Finished lab = calibrate("--robot 1 --set camera.dropout=0.6");
  EXPECT_EQ(lab.exit_code, 1) << lab.output;
  EXPECT_THAT(lab.output, HasSubstr("not seen by the tracker"));
}

TEST_F(CalibrateMotors, RefusesAnUnknownRobot) {
  const Finished lab = calibrate("--robot 7");
  EXPECT_EQ(lab.exit_code, 2);
  EXPECT_THAT(lab.output, HasSubstr("--robot 7: found no such robot"));
  EXPECT_FALSE(fs::exists(out()));
}

}  // namespace
}  // namespace lab::system_test
