/// Motor calibration files: the calibration/motors.toml that `lab calibrate motors` writes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <lab/motor_calibration_t.hpp>
#include <map>

namespace lab {

/// By robot id.
using MotorCalibrations = std::map<std::int32_t, motor_calibration_t>;

/// Reads the calibrations of a file. Keys that robots do not store are ignored.
/// @throws ExperimentError that names the file, the robot and the key
[[nodiscard]] MotorCalibrations readMotorFile(const std::filesystem::path& file);

}  // namespace lab
