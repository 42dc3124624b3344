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

/// How a calibration starts its lab.
/// @param file of the experiment
/// @param out where the folder of the run is made
/// @param options of one of the calibrate commands
template <class Options>
[[nodiscard]] LaunchOptions launchOptions(const std::filesystem::path& file,
                                          const std::filesystem::path& out,
                                          const Options& options) {
  return {.file = file,
          .out = out,
          .programs = options.programs,
          .set = options.set,
          .run_virtual = virtualTimeIf(options.virtual_time),
          .cameras = realCameras};
}

struct KnownCamera {
  CameraCalibration calibration;
  double error = 0;  ///< [m] rms residual; 0 if unknown or simulated
};

/// The camera of the experiment: the simulated camera exactly, a real one by its calibration.
/// @throws UserError if a real camera has no calibration; ExperimentError if it cannot be used
[[nodiscard]] KnownCamera cameraOf(const Experiment& experiment,
                                   const std::filesystem::path& directory);

}  // namespace lab::runner
