/// The folder of a run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "runner/user_program/user_program.hpp"

namespace lab::runner {

namespace files {
inline constexpr const char* kExperiment = "experiment.toml";
inline constexpr const char* kLog = "log.lcmlog";
inline constexpr const char* kProvenance = "provenance.json";
inline constexpr const char* kImages = "images";
inline constexpr const char* kCalibration = "calibration";
inline constexpr const char* kServiceLogs = "logs";
inline constexpr const char* kPorts = "ports";  ///< while it runs: serial lines of simulated robots
}  // namespace files

/// The option of `lab run` and others that names the folder of runs.
inline constexpr const char* kRunsOption = "--runs";

/// Makes `parent`/<name>-<UTC time>, with a number appended if that exists: nothing is overwritten.
/// @param option that chooses another `parent`, for the message
/// @throws UserError when it cannot be made
[[nodiscard]] std::filesystem::path makeRunDirectory(const std::filesystem::path& parent,
                                                     const std::string& name, std::int64_t utime,
                                                     const char* option = kRunsOption);

/// Checks that the projector can show every step of the script, with one copy of a layer per
/// followed robot.
/// @throws UserError that names the step
void checkScenes(const Experiment& experiment, const std::filesystem::path& source);

/// Checks all files, folders and devices that the experiment names, as prepareRun() does, without
/// making anything.
/// @param source folder to which the paths are relative
/// @throws ExperimentError, UserError for one that cannot be used
void checkFiles(const Experiment& experiment, const std::filesystem::path& source);

/// Copies the images of the light script into the run, named by their SHA-256, and changes their
/// paths in the experiment.
/// @param source folder to which the paths are relative
/// @throws UserError when an image cannot be read
void adoptImages(Experiment& experiment, const std::filesystem::path& source,
                 const std::filesystem::path& run);

/// Writes a new file completely or not at all.
/// @throws UserError when it exists or cannot be written
void writeNewFile(const std::filesystem::path& path, const std::string& text);

/// "2026-01-31T12:00:00Z"
[[nodiscard]] std::string utcText(std::int64_t utime);

/// Text of the calibration file for the tracker: the experiment's file, or the exact calibration of
/// the simulated camera.
/// @param source folder to which its path is relative
/// @throws ExperimentError, UserError when it cannot be read or is for another picture size
[[nodiscard]] std::string cameraInForce(const Experiment& experiment,
                                        const std::filesystem::path& source);

/// The same of all cameras, in the order of camerasOf().
[[nodiscard]] std::vector<std::string> camerasInForce(const Experiment& experiment,
                                                      const std::filesystem::path& source);

/// Disk space that a run of this experiment needs, with a margin: log, trajectories, figures, and a
/// reserve that stays free [bytes].
[[nodiscard]] std::int64_t diskNeed_bytes(const Experiment& experiment);

/// An experiment ready to run, with its folder.
struct PreparedRun {
  Experiment experiment;
  std::string effective;  ///< text of experiment.toml, with every default filled in
  std::filesystem::path directory;
  /// False: a run in virtual time leaves out the analyzer, whose results nobody reads meanwhile.
  bool live_analysis = true;
  std::size_t threads = 0;                    ///< of the simulator; 0: one per processor
  std::optional<UserProgram> user_program{};  ///< takes part in the run
};

/// Makes the folder with experiment.toml, images and calibrations.
/// @param option see makeRunDirectory()
[[nodiscard]] PreparedRun prepareRun(Experiment experiment, const std::filesystem::path& source,
                                     const std::filesystem::path& parent, std::int64_t utime,
                                     const char* option = kRunsOption);

/// The same for files that checkFiles() has accepted. They are not checked again, because that
/// reads all images and recordings.
[[nodiscard]] PreparedRun prepareCheckedRun(Experiment experiment,
                                            const std::filesystem::path& source,
                                            const std::filesystem::path& parent, std::int64_t utime,
                                            const char* option = kRunsOption);

}  // namespace lab::runner
