/// What the simulated twins of a run share with it, read from its log.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analyzer/analyze_run.hpp"
#include "common/experiment/experiment.hpp"

namespace lab::report {

/// A camera frame of the run.
struct RecordedFrame {
  double t = 0;                       ///< [s] of the exposure, since the start of the script
  std::vector<std::int32_t> missing;  ///< robots of the experiment that it does not have
};

/// A step of the light script as it was shown.
struct RecordedStep {
  int number = 0;  ///< of the presentation, from 0 over the whole run
  std::string label;
  double at = 0;  ///< [s] since the start of the script
};

struct TwinFacts {
  Experiment experiment;
  double duration = 0;  ///< [s] of the script, until its end or the last frame
  bool ended = false;   ///< the log has an END event
  std::vector<RecordedFrame> frames;
  std::vector<RecordedStep> steps;
  std::map<std::int32_t, StartPose> first_poses;  ///< of each robot, at the start of the script
  std::optional<double> position_noise;           ///< [m] measured standard deviation per axis
  std::optional<double> heading_noise;            ///< [rad] measured standard deviation
  std::string version;                            ///< of the software that ran
  std::size_t marks = 0;                          ///< remarks: among them what users did by hand
  std::string summary;                            ///< the text of summary.json, for the options
};

/// Reads the log of a run.
/// @throws ReportError if the log cannot be used, or does not have its experiment or any frame
[[nodiscard]] TwinFacts readTwinFacts(const std::filesystem::path& run_or_log,
                                      const AnalyzeOptions& options);

}  // namespace lab::report
