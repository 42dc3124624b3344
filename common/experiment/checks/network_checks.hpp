/// Checks of hosts, services and networks.
#pragma once

#include "common/experiment/keys/experiment_form.hpp"
#include "common/files/file_problems.hpp"

namespace lab::keys {

/// Checks that services run on named hosts, that the hosts are joined in a way that works, and that
/// the lab is open to a network only where the file says so explicitly.
void checkNetworks(const ExperimentForm& form, Problems& problems);

}  // namespace lab::keys
