/// Photometric calibrations on disk: the light.json that `lab calibrate light` writes.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <lab/robot_command_t.hpp>
#include <map>
#include <optional>
#include <string>

#include "common/experiment/experiment.hpp"
#include "light/photometry/projector_tone.hpp"

namespace lab {

/// How strongly a robot's two light sensors read, beside a middling one's 1.
struct SensorGains {
  double front = 1;
  double back = 1;

  bool operator==(const SensorGains&) const = default;
};

/// A sensor reads g (ambient + scale V(x, y) value^gamma) where a pixel of that value lights it
/// (optics::ProjectorTone, light/photometry/light_fit.hpp).
struct LightCalibration {
  double gamma = 1;
  std::array<double, 5> vignetting{};
  double scale = 1;                           ///< [1]
  double ambient = 0;                         ///< [1]
  std::map<std::int32_t, SensorGains> gains;  ///< by robot
  double residual = 0;                        ///< [1] rms of the readings
  double arena_width = 1.20;                  ///< [m]
  double arena_height = 0.90;                 ///< [m]
  std::string id;                             ///< first 12 digits of the file's SHA-256

  [[nodiscard]] optics::ProjectorTone tone() const {
    return {gamma, vignetting, arena_width, arena_height};
  }

  /// What the robot's sensor of the light table reads in light of this intensity, wherever it is.
  [[nodiscard]] double reading(std::int32_t robot, LightSensor sensor, double intensity) const;
};

/// The same orders with the bands of each robot where its own sensors read the light that the table
/// says.
[[nodiscard]] robot_command_t withCalibratedBands(const robot_command_t& command,
                                                  const LightCalibration& calibration);

/// What LIGHT_STATUS says of the calibrations in force, either of which may be empty.
[[nodiscard]] inline std::string joinCalibrationIds(const std::string& projector,
                                                    const std::string& light) {
  return projector.empty() || light.empty() ? projector + light : projector + " " + light;
}

/// @throws ExperimentError that names the file, the key, what was found and what was expected.
[[nodiscard]] LightCalibration readLightFile(const std::filesystem::path& file);

/// The same from a file's text. @param name of the file, for messages
[[nodiscard]] LightCalibration parseLightFile(const std::string& name, const std::string& text);

[[nodiscard]] std::string lightFileText(const LightCalibration& calibration);

/// The calibration that the experiment names, nothing where it names none.
/// @param directory that the path is relative to
/// @throws ExperimentError when it cannot be used: not there, of an arena of another size.
[[nodiscard]] std::optional<LightCalibration> activeLightCalibration(
    const Experiment& experiment, const std::filesystem::path& directory);

}  // namespace lab
