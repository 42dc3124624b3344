/// Conversions from an experiment to the simulation's settings.
#pragma once

#include <cstdint>
#include <filesystem>
#include <lab/robot_calibration_t.hpp>
#include <vector>

#include "common/calibration/motor_file.hpp"
#include "common/experiment/experiment.hpp"
#include "robot/firmware/settings.hpp"
#include "sim_svc/world.hpp"

namespace lab::sim {

[[nodiscard]] WorldSettings worldSettings(const Experiment& experiment);

/// The robots of the world: those of the experiment that are simulated, in the same order.
[[nodiscard]] std::vector<RobotSetup> simulatedRobots(const Experiment& experiment);

/// Indices of the world's robots with this body.
[[nodiscard]] std::vector<std::size_t> robotsWithBody(const Experiment& experiment, Body body);

/// The motor calibrations that the experiment names; empty if it names no file.
/// @param directory that the file's path is relative to
/// @throws what readMotorFile() throws
[[nodiscard]] MotorCalibrations activeMotors(const Experiment& experiment,
                                             const std::filesystem::path& directory);

[[nodiscard]] robot_calibration_t toMessage(const MotorCalibrations& motors);

/// The initial contents of the EEPROM of a simulated robot.
[[nodiscard]] firmware::Settings storedSettings(const Experiment& experiment,
                                                const MotorCalibrations& motors, std::int32_t id);

/// A wheel's calibration as the EEPROM stores it: the dead band in whole duties, all values limited
/// to what the robot accepts.
/// @param dead_band share of full duty
[[nodiscard]] dynamics::WheelCalibration wheelCalibration(double gain, double dead_band);

}  // namespace lab::sim
