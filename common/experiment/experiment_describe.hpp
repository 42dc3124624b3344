/// An experiment as text for the terminal.
#pragma once

#include <functional>
#include <string>

#include "common/experiment/experiment.hpp"

namespace lab {

/// The persistence length of a program [m]. Only the exact laws know it (analyzer/laws.hpp), which
/// common/ does not link.
using PersistenceLength = std::function<double(const RobotProgram&)>;

/// What a run of this experiment would start, in about twenty lines: the run, its robots, programs
/// with the quantities that follow from them, the light script with the programs that it selects,
/// and the expected size of the log.
/// @param length empty: persistence lengths are left out
[[nodiscard]] std::string describeExperiment(const Experiment& experiment,
                                             const PersistenceLength& length = {});

}  // namespace lab
