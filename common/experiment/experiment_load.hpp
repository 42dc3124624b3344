/// The processor time that a live run is expected to need.
#pragma once

#include <string>
#include <vector>

#include "common/experiment/experiment.hpp"

namespace lab {

/// A process of a run.
struct ProcessLoad {
  std::string process;
  double cores = 0;  ///< CPU seconds per second
  int threads = 1;   ///< that work, so the most cores that it can use
};

/// The processes that a live run has on this machine, the busiest first. Measured on one machine
/// (docs/robots_per_core.md): others differ by a factor of two.
/// @param dashboard whether the run has one
[[nodiscard]] std::vector<ProcessLoad> expectedLoad(const Experiment& experiment,
                                                    bool dashboard = false);

/// Why this machine is too slow for a live run, with the way out; empty if it is not.
/// @param cores of this machine
/// @param dashboard whether the run has one
[[nodiscard]] std::string loadProblem(const Experiment& experiment, unsigned cores,
                                      bool dashboard = false);

}  // namespace lab
