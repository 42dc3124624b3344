/// Photometric calibration files: the light.json that `lab calibrate light` writes.
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

/// The gains of a robot's two light sensors, relative to the mean gain of all sensors.
struct SensorGains {
  double front = 1;
  double back = 1;

  bool operator==(const SensorGains&) const = default;
};

/// A photometric calibration. A sensor with gain g under a pixel of this value reads
/// g (ambient + scale V(x, y) value^gamma); see optics::ProjectorTone and
/// light/photometry/light_fit.hpp.
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

  /// The reading of a robot's sensor in light of this intensity. The projector compensates
  /// vignetting, so it does not depend on the position.
  [[nodiscard]] double reading(std::int32_t robot, LightSensor sensor, double intensity) const;
};

/// Orders for each single robot, with the bands converted from light intensities to readings of its
/// own sensors. Only the first order has the texts of the programs.
[[nodiscard]] robot_command_t withCalibratedBands(const robot_command_t& command,
                                                  const LightCalibration& calibration);

/// The calibration_id of LIGHT_STATUS, from the two ids, either of which may be empty.
[[nodiscard]] inline std::string joinCalibrationIds(const std::string& projector,
                                                    const std::string& light) {
  return projector.empty() || light.empty() ? projector + light : projector + " " + light;
}

/// Reads a file.
/// @throws ExperimentError that names the file, the key, what was found and what was expected
[[nodiscard]] LightCalibration readLightFile(const std::filesystem::path& file);

/// As readLightFile(), from the text of a file.
/// @param name of the file, for messages
[[nodiscard]] LightCalibration parseLightFile(const std::string& name, const std::string& text);

/// The text of the file that readLightFile() reads.
[[nodiscard]] std::string lightFileText(const LightCalibration& calibration);

/// Reads the calibration that the experiment names.
/// @param directory that the path is relative to
/// @return nothing if the experiment names none
/// @throws ExperimentError if the file is missing or wrong, or of an arena of another size
[[nodiscard]] std::optional<LightCalibration> activeLightCalibration(
    const Experiment& experiment, const std::filesystem::path& directory);

}  // namespace lab
