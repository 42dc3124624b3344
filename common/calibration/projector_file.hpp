/// Geometric calibration files of projectors: the projector.json that `lab calibrate projector` or
/// projector_ctl writes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "common/experiment/experiment.hpp"
#include "light/optics/projector_model.hpp"

namespace lab {

/// The geometric calibration of a projector.
struct ProjectorCalibration {
  /// Maps each place at `height` to its pixel of the display's picture. fx is negative if the
  /// picture is mirrored.
  optics::CameraParameters lens;
  double height = 0.05;            ///< [m] of the places above the floor
  double arena_width = 1.20;       ///< [m]
  double arena_height = 0.90;      ///< [m]
  std::string method;              ///< "camera", or "corners": adjusted by hand, without distortion
  std::string camera_id;           ///< of the camera's calibration, empty with "corners"
  std::optional<double> residual;  ///< [m] rms error of the lens model over the arena
  std::optional<double> accuracy;  ///< [m] rms total error of where light falls
  std::optional<double> worst;     ///< [m] largest mean residual of a 10 cm square
  std::optional<double> covered;   ///< [1] measured fraction of the arena
  std::string id;                  ///< first 12 digits of the file's SHA-256

  [[nodiscard]] optics::ProjectorModel model() const { return {lens, height}; }
};

/// Reads a file.
/// @throws ExperimentError that names the file, the key, what was found and what was expected
[[nodiscard]] ProjectorCalibration readProjectorFile(const std::filesystem::path& file);

/// The text of the file that readProjectorFile() reads. It has only measured values, so equal
/// calibrations give equal texts.
[[nodiscard]] std::string projectorFileText(const ProjectorCalibration& calibration);

/// The calibration in use by projector_ctl, and by code that predicts what it shows.
struct ActiveProjectorCalibration {
  optics::ProjectorModel model;
  std::string id;  ///< empty: no calibration, the arena fills the picture
};

/// Reads the calibration that the experiment names, for a picture of columns x rows pixels.
/// @param directory that the path is relative to
/// @throws ExperimentError if the file is missing or wrong, or of a picture or arena of another
/// size
[[nodiscard]] ActiveProjectorCalibration activeProjectorCalibration(
    const Experiment& experiment, const std::filesystem::path& directory, int columns, int rows);

/// Checks the experiment's calibration as far as possible before the display is open.
/// @throws ExperimentError if it cannot be used
void checkProjectorFile(const Experiment& experiment, const std::filesystem::path& directory);

}  // namespace lab
