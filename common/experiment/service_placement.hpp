/// The hosts of an experiment's services.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "common/experiment/experiment.hpp"

namespace lab {

/// The services that may be placed on other hosts.
inline constexpr std::array<std::string_view, 6> kServiceNames{
    "analyzer", "projector_ctl", "robot_bridge", "tracker_svc", "sim_svc", "dds_gateway"};

/// The service that only observes; a run does not depend on it.
inline constexpr std::string_view kObserverService = "dashboard";

/// The host of a service as written in the file; empty: this machine.
[[nodiscard]] std::string hostOf(const Experiment& experiment, std::string_view service);

/// The other hosts that run services, each once, sorted by name.
[[nodiscard]] std::vector<std::string> otherHosts(const Experiment& experiment);

/// The entry of a host. If the file has none, one that uses the name for ssh. `ssh` is never empty.
[[nodiscard]] HostSpec hostSpec(const Experiment& experiment, const std::string& host);

/// Whether the page can be reached only from this machine.
[[nodiscard]] bool isLocalOnly(const Dashboard& dashboard);

}  // namespace lab
