/// Who else can reach the lab of an experiment, as text.
#pragma once

#include <string>

#include "common/experiment/experiment.hpp"

namespace lab {

/// "open to the network (ttl 1): every machine there can read it and drive the robots"; empty for
/// a bus whose messages stay on this machine.
[[nodiscard]] std::string openBusText(const Network& network);

/// The lines of the bus, of ROS 2, of the dashboard and of other hosts; without those that the
/// experiment does not use, or that only this machine reaches.
[[nodiscard]] std::string describeReach(const Experiment& experiment);

}  // namespace lab
