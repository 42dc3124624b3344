/// The services of a lab in which everything is simulated.
#pragma once

#include <vector>

#include "common/service_main.hpp"

namespace lab::runner {

/// In the order of starting: who is listened to starts first.
[[nodiscard]] std::vector<ServiceDescription> labServices();

}  // namespace lab::runner
