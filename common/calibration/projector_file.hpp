/// Geometric calibrations of projectors on disk: the projector.json that `lab calibrate projector`
/// writes, or the projector's own keys.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "common/experiment/experiment.hpp"
#include "light/optics/projector_model.hpp"

namespace lab {

/// What is known of where a projector's pixels fall.
struct ProjectorCalibration {
  /// Pixel of the display's picture for each place at `height`. A negative fx: seen in a mirror.
  optics::CameraParameters lens;
  double height = 0.05;            ///< [m] above the floor at which places are meant
  double arena_width = 1.20;       ///< [m]
  double arena_height = 0.90;      ///< [m]
  std::string method;              ///< "camera", or "corners": by hand, without a lens's distortion
  std::string camera_id;           ///< of the camera's calibration, empty: by hand
  std::optional<double> residual;  ///< [m] rms over the arena of what the lens does not describe
  std::optional<double> accuracy;  ///< [m] rms over the arena of where light falls, all told
  std::optional<double> worst;     ///< [m] largest of the residuals' means over 10 cm squares
  std::optional<double> covered;   ///< [1] share of the arena where the picture was measured
  std::string id;                  ///< first 12 digits of the file's SHA-256

  [[nodiscard]] optics::ProjectorModel model() const { return {lens, height}; }
};

/// @throws ExperimentError that names the file, the key, what was found and what was expected.
[[nodiscard]] ProjectorCalibration readProjectorFile(const std::filesystem::path& file);

/// The same with nothing in it but what was measured: two equal calibrations are two equal texts.
[[nodiscard]] std::string projectorFileText(const ProjectorCalibration& calibration);

/// What projector_ctl goes by, and whoever wants to know what it shows.
struct ActiveProjectorCalibration {
  optics::ProjectorModel model;
  std::string id;  ///< of the calibration, empty: there is none, the arena fills the picture
};

/// The calibration that the experiment names, for a picture of columns x rows.
/// @param directory that the path is relative to
/// @throws ExperimentError when it cannot be used: not there, of a picture or arena of another
/// size.
[[nodiscard]] ActiveProjectorCalibration activeProjectorCalibration(
    const Experiment& experiment, const std::filesystem::path& directory, int columns, int rows);

/// Whether the experiment's calibration can be used, as far as that shows before the display is
/// open.
/// @throws ExperimentError when not.
void checkProjectorFile(const Experiment& experiment, const std::filesystem::path& directory);

}  // namespace lab
