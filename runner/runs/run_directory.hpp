/// The folder that a run leaves behind.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "common/experiment/experiment.hpp"

namespace lab::runner {

namespace files {
inline constexpr const char* kExperiment = "experiment.toml";
inline constexpr const char* kLog = "log.lcmlog";
inline constexpr const char* kProvenance = "provenance.json";
inline constexpr const char* kImages = "images";
inline constexpr const char* kCalibration = "calibration";
inline constexpr const char* kServiceLogs = "logs";
inline constexpr const char* kPorts = "ports";  ///< while it runs: lines of simulated robots
}  // namespace files

/// Makes `parent`/<name>-<UTC time>, with a number behind it when that exists: nothing is ever
/// overwritten. @throws UserError when it cannot be made.
[[nodiscard]] std::filesystem::path makeRunDirectory(const std::filesystem::path& parent,
                                                     const std::string& name, std::int64_t utime);

/// Whether the projector takes every step of the script, copies for robots counted.
/// @throws UserError that names the step
void checkScenes(const Experiment& experiment, const std::filesystem::path& source);

/// Copies the images of the light script into the run, named by their SHA-256, and lets the
/// experiment speak of them by that name. @param source folder that the script's paths are relative
/// to. @throws UserError when an image cannot be read.
void adoptImages(Experiment& experiment, const std::filesystem::path& source,
                 const std::filesystem::path& run);

/// Writes a whole new file, or none. @throws UserError when it exists or cannot be written.
void writeNewFile(const std::filesystem::path& path, const std::string& text);

/// "2026-01-31T12:00:00Z"
[[nodiscard]] std::string utcText(std::int64_t utime);

/// The calibration file that the tracker is to use: as the experiment says it, or the simulated
/// camera's own, which is then made. @param source folder that the path is relative to.
/// @throws ExperimentError, UserError when it cannot be read or is of pictures of another size.
[[nodiscard]] std::string cameraInForce(const Experiment& experiment,
                                        const std::filesystem::path& source);

/// Disk space that a run of this experiment needs, with a margin: log, trajectories, figures, and a
/// reserve that stays free [bytes].
[[nodiscard]] std::int64_t diskNeed_bytes(const Experiment& experiment);

/// The experiment file as run, for the folder and the record.
struct PreparedRun {
  Experiment experiment;
  std::string effective;  ///< experiment.toml's text
  std::filesystem::path directory;
};

/// Makes the folder with experiment.toml and the images in it.
[[nodiscard]] PreparedRun prepareRun(Experiment experiment, const std::filesystem::path& source,
                                     const std::filesystem::path& parent, std::int64_t utime);

}  // namespace lab::runner
