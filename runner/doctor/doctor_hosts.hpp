/// What the doctor says of the other hosts of an experiment.
#pragma once

#include <vector>

#include "common/experiment/experiment.hpp"
#include "runner/doctor/doctor.hpp"

namespace lab::runner {

/// Visits each host that services are placed on: reachable, the same lab, the same time. Starts
/// nothing there but the agent that answers.
[[nodiscard]] std::vector<Finding> examineHosts(const Experiment& experiment);

}  // namespace lab::runner
