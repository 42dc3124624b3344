/// Motor calibrations on disk: the calibration/motors.toml that `lab calibrate motors` writes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <lab/motor_calibration_t.hpp>
#include <map>

namespace lab {

/// By robot id.
using MotorCalibrations = std::map<std::int32_t, motor_calibration_t>;

/// What each robot of the file holds. Other keys than those that a robot holds are not read.
/// @throws ExperimentError that names the file, the robot and the key.
[[nodiscard]] MotorCalibrations readMotorFile(const std::filesystem::path& file);

}  // namespace lab
