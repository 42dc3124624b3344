/// The keys of the bus, the ROS 2 gateway, the dashboard, hosts and services.
#pragma once

#include "common/experiment/keys/experiment_form.hpp"
#include "common/experiment/keys/key_visitor.hpp"

namespace lab::keys {

void visitNetworks(KeyVisitor& v, Experiment& e);

}  // namespace lab::keys
