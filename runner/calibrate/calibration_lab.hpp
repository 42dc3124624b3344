/// Experiments for the calibration of projector, light and robots.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "common/calibration/camera_file.hpp"
#include "common/experiment/experiment.hpp"
#include "runner/live/launch.hpp"

namespace lab::runner {

/// The experiment with uniform constant light instead of its light script.
/// @param suffix added to the name of the run
/// @param duration longest duration [s]
/// @param intensity [1]
[[nodiscard]] Experiment labUnderSteadyLight(Experiment experiment, const std::string& suffix,
                                             double duration, double intensity);

/// The experiment for a ProjectorCalibrator, dark until it begins. It has one robot, because an
/// experiment needs one; the tracker does not use a real camera, which allows only one reader.
/// @param lights number of lights, each filmed in `frames` frames
[[nodiscard]] Experiment filmedLab(Experiment experiment, const std::string& suffix,
                                   std::size_t lights, std::int64_t frames);

/// For LaunchOptions: how to run in virtual time, or nothing.
[[nodiscard]] RunVirtual virtualTimeIf(bool wanted);

/// For LaunchOptions: the cameras of this machine.
[[nodiscard]] std::unique_ptr<Cameras> realCameras(AsioLoop& loop,
                                                   const std::filesystem::path& folder);

struct KnownCamera {
  CameraCalibration calibration;
  double error = 0;  ///< [m] rms residual; 0 if unknown or simulated
};

/// The camera of the experiment: the simulated camera exactly, a real one by its calibration.
/// @throws UserError if a real camera has no calibration; ExperimentError if it cannot be used
[[nodiscard]] KnownCamera cameraOf(const Experiment& experiment,
                                   const std::filesystem::path& directory);

}  // namespace lab::runner
