/// The services of a lab.
#pragma once

#include <string>
#include <vector>

#include "common/service/service_main.hpp"

namespace lab::runner {

/// Those an experiment has work for, in the order of starting and of ending: who is listened to
/// starts first, and the bridge ends before the robots it talks to.
[[nodiscard]] std::vector<ServiceDescription> labServices(const Experiment& experiment);

/// The other hosts that these are placed on, each once, in order of name.
[[nodiscard]] std::vector<std::string> hostsInUse(const Experiment& experiment);

}  // namespace lab::runner
