/// Which service of an experiment runs on which host, and who else reaches it.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "common/experiment/experiment.hpp"

namespace lab {

/// Every service that may be placed.
inline constexpr std::array<std::string_view, 6> kServiceNames{
    "analyzer", "projector_ctl", "robot_bridge", "tracker_svc", "sim_svc", "dds_gateway"};

/// Who looks on: a lab runs as well without it.
inline constexpr std::string_view kObserverService = "dashboard";

/// The host that the service is placed on, as the file says it; "": this machine.
[[nodiscard]] std::string hostOf(const Experiment& experiment, std::string_view service);

/// The other hosts that services are placed on, each once, in order of name.
[[nodiscard]] std::vector<std::string> otherHosts(const Experiment& experiment);

/// The host's entry, where the file has none one that ssh alone knows. Its `ssh` is never empty.
[[nodiscard]] HostSpec hostSpec(const Experiment& experiment, const std::string& host);

/// Whether no other machine reaches the page.
[[nodiscard]] bool isLocalOnly(const Dashboard& dashboard);

}  // namespace lab
