#include "common/experiment/experiment_reach.hpp"

#include <cstdint>
#include <string_view>
#include <vector>

#include "common/experiment/description_line.hpp"
#include "common/experiment/service_placement.hpp"

namespace lab {
namespace {

using description::line;

std::string describeBus(const Network& network) {
  const std::string open = openBusText(network);
  return open.empty() ? "" : line("bus", open);
}

/// What ROS 2 may do here, and who that is.
std::string describeCommands(const Gateway& gateway) {
  if (!gateway.commands) return line("", "may observe, but not drive");
  std::string who = gateway.command_robots.empty() ? " all" : "";
  for (const std::int32_t id : gateway.command_robots) who += " " + std::to_string(id);
  const std::string text =
      line("", std::string("may set the light") + (gateway.load_programs ? ", load programs" : "") +
                   " and drive robots:" + who);
  const bool leaves = !gateway.address.empty() || !gateway.configuration.empty();
  if (!leaves || !gateway.security.empty()) return text;
  return text + line("",
                     "warning: taken without DDS Security, so from every machine of that "
                     "network");
}

/// How far the ROS 2 gateway reaches, and what it may command.
std::string describeRos(const Experiment& e) {
  const Gateway& gateway = e.gateway;
  if (!gateway.ros) return {};
  const std::string reach = !gateway.configuration.empty() ? "as " + gateway.configuration + " says"
                            : gateway.address.empty()      ? "on this machine only"
                                                           : "by " + gateway.address;
  const char* secured = !gateway.security.empty()  ? ", secured"
                        : !gateway.address.empty() ? ", unsecured: every machine there can read it"
                                                   : "";
  return line("ROS 2", "topics /" + gateway.name + "/..., domain " +
                           std::to_string(gateway.domain) + ", " + reach + secured) +
         describeCommands(gateway);
}

/// Who else can open the page, and use its buttons.
std::string describeDashboard(const Dashboard& dashboard) {
  if (isLocalOnly(dashboard)) return {};
  return line("dashboard",
              "listens on " + dashboard.address +
                  ", unencrypted: everyone who can reach it sees the lab and its runs") +
         line("", dashboard.control_from_elsewhere
                      ? "warning: everyone who has the printed address, or can read the traffic of "
                        "that network, may drive robots and light"
                      : "and cannot control it: buttons work on this machine only");
}

/// "bench: sim_svc, robot_bridge (ssh pi@robot-bench)"
std::string describeHosts(const Experiment& e) {
  const std::vector<std::string> hosts = otherHosts(e);
  std::string text;
  for (const std::string& host : hosts) {
    std::string services;
    for (const std::string_view service : kServiceNames) {
      if (hostOf(e, service) == host)
        services += (services.empty() ? "" : ", ") + std::string(service);
    }
    text += line(text.empty() ? "hosts" : "",
                 host + ": " + services + " (ssh " + hostSpec(e, host).ssh + ")");
  }
  if (hosts.empty()) return text;
  if (e.link.join == JoinBy::kMulticast) return text + line("", "joined by LCM multicast");
  return text + line("", std::string("joined by DDS, domain ") + std::to_string(e.link.domain) +
                             (e.link.security.empty() ? ", unsecured" : ", secured"));
}

}  // namespace

std::string openBusText(const Network& network) {
  if (network.ttl == 0) return {};
  return "open to the network (ttl " + std::to_string(network.ttl) +
         "): every machine there can read it and drive the robots";
}

std::string describeReach(const Experiment& experiment) {
  return describeBus(experiment.network) + describeRos(experiment) +
         describeDashboard(experiment.dashboard) + describeHosts(experiment);
}

}  // namespace lab
