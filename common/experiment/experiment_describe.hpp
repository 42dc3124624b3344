/// An experiment as text for the terminal.
#pragma once

#include <functional>
#include <string>

#include "common/experiment/experiment.hpp"

namespace lab {

/// What follows from a program's parameters: "D_r = 0.6 rad^2/s, L_s = 7 cm". Only its law knows it
/// (analyzer/laws/), which common/ does not link.
using ProgramCoefficients = std::function<std::string(const Program&)>;

/// What a run of this experiment would start, in about twenty lines: the run, its robots, programs
/// with the quantities that follow from them, the light script with the programs that it selects,
/// and the expected size of the log.
/// @param coefficients empty: they are left out
[[nodiscard]] std::string describeExperiment(const Experiment& experiment,
                                             const ProgramCoefficients& coefficients = {});

/// What a virtual sense measures, with the unit in which programs read it: "distance of the nearest
/// robot within 15 cm (cm)".
[[nodiscard]] std::string senseText(const SenseSpec& sense);

}  // namespace lab
