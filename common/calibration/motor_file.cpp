#include "common/calibration/motor_file.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <cmath>
#include <string>

#include "common/files/experiment_error.hpp"
#include "common/files/file_text.hpp"
#include "common/files/toml_text.hpp"
#include "common/math/units.hpp"

namespace lab {
namespace {

class Reader {
 public:
  explicit Reader(const std::filesystem::path& file) : name_(file.string()) {}

  MotorCalibrations read() const {
    const toml::table root = parse();
    const toml::array* robots = root["robots"].as_array();
    if (robots == nullptr) fail("found no [[robots]], expected a file of lab calibrate motors");
    MotorCalibrations motors;
    for (const toml::node& node : *robots) {
      const toml::table* robot = node.as_table();
      if (robot == nullptr) fail("robots: found a value, expected [[robots]] tables");
      const auto calibration = readRobot(*robot);
      if (!motors.emplace(calibration.robot_id, calibration).second) {
        fail(fmt::format("robot {} occurs twice", calibration.robot_id));
      }
    }
    return motors;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw ExperimentError({name_ + ": " + what});
  }

  toml::table parse() const {
    const std::string text = readFileText(name_, file_kinds::kCalibration);
    try {
      return keys::parseToml(text, name_);
    } catch (const keys::TomlError& error) {
      fail(fmt::format("line {}: {}", error.at().line, error.what()));
    }
  }

  double number(const toml::table& robot, const char* key, double low, double high) const {
    const auto value = robot[key].value<double>();
    const auto id = robot["id"].value_exact<std::int64_t>().value_or(0);
    if (!value) fail(fmt::format("robot {}: {}: found no number, it is needed", id, key));
    if (!(*value >= low && *value <= high)) {
      fail(fmt::format("robot {}: {}: found {:g}, allowed {:g} to {:g}", id, key, *value, low,
                       high));
    }
    return *value;
  }

  // The limits are those of the robots' firmware.
  motor_calibration_t readRobot(const toml::table& robot) const {
    if (!robot["id"].is_integer()) {
      fail("id: found no whole number, expected that of a robot in each [[robots]]");
    }
    motor_calibration_t motors{};
    motors.robot_id = static_cast<std::int32_t>(number(robot, "id", 1, 1e9));
    motors.gain_left = number(robot, "gain_left", 0.5, 1.5);
    motors.gain_right = number(robot, "gain_right", 0.5, 1.5);
    motors.dead_band_left = number(robot, "dead_band_left_percent", 0, 49.8) * units::kPercent;
    motors.dead_band_right = number(robot, "dead_band_right_percent", 0, 49.8) * units::kPercent;
    motors.wheel_base = number(robot, "wheel_base_cm", 1, 50) * units::kCentimetre;
    return motors;
  }

  std::string name_;
};

}  // namespace

MotorCalibrations readMotorFile(const std::filesystem::path& file) { return Reader(file).read(); }

}  // namespace lab
