/// Checks of `lab doctor` on the other hosts of an experiment.
#pragma once

#include <vector>

#include "common/experiment/experiment.hpp"
#include "runner/doctor/doctor.hpp"

namespace lab::runner {

/// Checks every host that runs services: reachable, same version, clocks agree. Starts only the
/// host agent there.
[[nodiscard]] std::vector<Finding> examineHosts(const Experiment& experiment);

}  // namespace lab::runner
