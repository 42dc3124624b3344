/// The experiment of a run's twins. Pure functions.
#pragma once

#include <string>
#include <vector>

#include "analyzer/twin_facts.hpp"
#include "common/experiment/experiment.hpp"

namespace lab::runner::campaign {

struct TwinExperiment {
  Experiment experiment;  ///< without camera.frames, whose file is framesText()
  /// What the twins do not repeat, a sentence each.
  std::vector<std::string> remarks;
};

/// The run's own experiment, simulated, with what was recorded: the duration, the times at which
/// the light changed, the measured noise, and the places where robots were at the begin.
[[nodiscard]] TwinExperiment twinExperimentOf(const report::TwinFacts& facts);

/// The file of camera.frames: times of the frames and robots that are missing in each.
[[nodiscard]] std::string framesText(const std::vector<report::RecordedFrame>& frames);

}  // namespace lab::runner::campaign
