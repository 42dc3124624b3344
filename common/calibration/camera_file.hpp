/// Camera calibration files: the camera.json that `lab calibrate camera` writes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "light/optics/camera_model.hpp"
#include "light/optics/cap.hpp"
#include "light/photometry/imaging.hpp"

namespace lab {

/// The calibration of a camera over an arena.
struct CameraCalibration {
  optics::CameraParameters camera;
  optics::CapGeometry cap;
  std::optional<optics::Imaging> imaging;  ///< empty: not measured
  double arena_width = 1.20;               ///< [m]
  double arena_height = 0.90;              ///< [m]
  std::optional<double> residual;          ///< [m] root mean square over the arena, at cap height
  std::string id;                          ///< first 12 digits of the file's SHA-256
};

/// Reads one of two forms: the one of this software in SI units ("form": "active-lab camera 1"), or
/// K, dist, R, t and geometry in centimetres, as OpenCV users write them (docs/cameras.md).
/// @throws ExperimentError that names the file, the key, what was found and what was expected
[[nodiscard]] CameraCalibration readCameraFile(const std::filesystem::path& file);

/// The text of a file in the form of this software.
[[nodiscard]] std::string cameraFileText(const CameraCalibration& calibration);

}  // namespace lab
