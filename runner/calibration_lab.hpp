/// The lab of an experiment file, made ready for measuring.
#pragma once

#include <string>

#include "common/experiment.hpp"

namespace lab::runner {

/// The experiment with one uniform light from begin to end, instead of its script.
/// @param suffix of its name, for the run's folder
/// @param duration [s] at most
[[nodiscard]] Experiment labUnderSteadyLight(Experiment experiment, const std::string& suffix,
                                             double duration, double intensity);

}  // namespace lab::runner
