/// Checks of hosts, services and networks.
#pragma once

#include <filesystem>
#include <optional>

#include "common/experiment/keys/experiment_form.hpp"
#include "common/files/file_problems.hpp"

namespace lab::keys {

/// Checks that services run on named hosts, that the hosts are joined in a way that works, and that
/// the lab is open to a network only where the file says so explicitly.
/// @param directory of the experiment file. If none is given, the text comes from a log and starts
///   nothing, so that it may have what only a command line may name.
void checkNetworks(const ExperimentForm& form,
                   const std::optional<std::filesystem::path>& directory, Problems& problems);

/// Checks that the gateway is open to a network only where the file says so explicitly.
void checkGateway(const Experiment& experiment, Problems& problems);

}  // namespace lab::keys
