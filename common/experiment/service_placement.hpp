/// The services that an experiment needs, and the host of each.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "common/experiment/experiment.hpp"

namespace lab {

/// Every service that may be placed on a host, in the order of starting and ending: receivers start
/// before senders, and robot_bridge ends before the robots it commands.
inline constexpr std::array<std::string_view, 6> kServiceNames{
    "analyzer", "projector_ctl", "robot_bridge", "tracker_svc", "sim_svc", "dds_gateway"};

/// The dashboard only observes: a lab runs without it too.
inline constexpr std::string_view kObserverService = "dashboard";

/// Whether the experiment needs this service.
[[nodiscard]] bool isNeeded(const Experiment& experiment, std::string_view service);

/// Whether the script or stop_when waits for estimates of the analyzer.
[[nodiscard]] bool waitsForEstimates(const Experiment& experiment);

/// Whether the script, stop_when or a layer of the light depends on collective numbers.
[[nodiscard]] bool needsCrowd(const Experiment& experiment);

/// Whether a run that needs this service can go on without it: nothing that happens to the robots
/// depends on it, and the log can be analyzed later.
[[nodiscard]] bool isDispensable(const Experiment& experiment, std::string_view service);

/// The services that the experiment needs, in the order of kServiceNames.
[[nodiscard]] std::vector<std::string> neededServices(const Experiment& experiment);

/// Whether the command line of the service has --ports.
[[nodiscard]] bool usesPorts(std::string_view service);

/// The other hosts on which the experiment places services that it needs, each once, sorted.
[[nodiscard]] std::vector<std::string> hostsInUse(const Experiment& experiment);

/// Whether DDS joins the buses of hosts, so that the gateways read link.security.
[[nodiscard]] bool isLinkedByDds(const Experiment& experiment);

/// The host on which the experiment file places the service; "": this machine.
[[nodiscard]] std::string hostOf(const Experiment& experiment, std::string_view service);

/// The other hosts on which the file places services, needed or not, each once, sorted.
[[nodiscard]] std::vector<std::string> otherHosts(const Experiment& experiment);

/// The host's entry in the file. A host without an entry is named as in ssh. `ssh` is never empty.
[[nodiscard]] HostSpec hostSpec(const Experiment& experiment, const std::string& host);

/// Whether the dashboard listens on a loopback address only.
[[nodiscard]] bool isLocalOnly(const Dashboard& dashboard);

}  // namespace lab
