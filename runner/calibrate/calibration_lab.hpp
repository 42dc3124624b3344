/// The labs in which projector, light and robots are calibrated.
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

/// The experiment's lab under one even light, in a run of its own: its light script is gone.
/// @param suffix of the run's name
/// @param duration [s] at most
/// @param intensity [1]
[[nodiscard]] Experiment labUnderSteadyLight(Experiment experiment, const std::string& suffix,
                                             double duration, double intensity);

/// The lab of a ProjectorCalibrator, dark until it begins: one simulated robot, as an experiment
/// has one and it is in nobody's way; the camera is nobody else's.
/// @param lights that are shown, each in so many frames
[[nodiscard]] Experiment filmedLab(Experiment experiment, const std::string& suffix,
                                   std::size_t lights, std::int64_t frames);

/// For LaunchOptions: how to run in virtual time, or nothing.
[[nodiscard]] RunVirtual virtualTimeIf(bool wanted);

/// For LaunchOptions: the cameras of this machine.
[[nodiscard]] std::unique_ptr<Cameras> realCameras(AsioLoop& loop,
                                                   const std::filesystem::path& folder);

struct KnownCamera {
  CameraCalibration calibration;
  double error = 0;  ///< [m] rms, 0: not known or none
};

/// The camera of the experiment: the simulated one as it is, a real one as calibrated.
/// @throws UserError when a real one has no calibration, ExperimentError when that cannot be used
[[nodiscard]] KnownCamera cameraOf(const Experiment& experiment,
                                   const std::filesystem::path& directory);

}  // namespace lab::runner
