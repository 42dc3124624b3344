#include "common/experiment/checks/network_checks.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/experiment/service_placement.hpp"
#include "common/files/file_values.hpp"

namespace lab::keys {
namespace {

bool hasHosts(const Experiment& e) { return !otherHosts(e).empty(); }

bool isPartOfSshName(std::string_view part, std::string_view more) {
  constexpr std::string_view kLetters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.-";
  return !part.empty() && part.front() != '-' && std::ranges::all_of(part, [&](char letter) {
    return kLetters.find(letter) != std::string_view::npos ||
           more.find(letter) != std::string_view::npos;
  });
}

/// Whether a name is "machine" or "user@machine". ssh takes names that begin with - for options,
/// ssh:// for an address with a port, and inserts names into commands of ~/.ssh/config.
bool isSshName(std::string_view name) {
  const std::size_t at = name.rfind('@');
  if (at == std::string_view::npos) return isPartOfSshName(name, ":");
  return isPartOfSshName(name.substr(0, at), "") && isPartOfSshName(name.substr(at + 1), ":");
}

std::string serviceList() {
  std::string list;
  for (const std::string_view name : kServiceNames) {
    list += (list.empty() ? "" : ", ") + std::string(name);
  }
  return list;
}

std::string hostList(const Experiment& e) {
  std::string list;
  for (const auto& [name, host] : e.hosts) list += (list.empty() ? "" : ", ") + name;
  return list.empty() ? "there is no [hosts.NAME]" : list;
}

void checkPlace(const Experiment& e, const ServicePlacement& place, Problems& problems) {
  const std::string path = "services." + place.service;
  if (std::ranges::find(kServiceNames, place.service) == kServiceNames.end()) {
    problems.add(path, "found an unknown service, allowed " + serviceList());
    return;
  }
  const std::string& host = place.host;
  if (host.empty() || e.hosts.contains(host)) return;
  const bool by_ssh = host.find('@') != std::string::npos && isSshName(host);
  if (by_ssh) return;
  problems.add(path + ".host", "found " + tomlString(host) +
                                   ", allowed \"\" (this machine), the name of a host (" +
                                   hostList(e) + ") or \"user@machine\" as ssh takes it");
}

void checkHost(const HostSpec& host, Problems& problems) {
  if (host.ssh.empty() || isSshName(host.ssh)) return;
  problems.add("hosts." + host.name + ".ssh",
               "found " + tomlString(host.ssh) +
                   ", allowed \"machine\" or \"user@machine\" "
                   "of letters, digits and _ . - (machine also :), none beginning with -; options "
                   "such as a port belong into ~/.ssh/config");
}

/// Checks that two services run on the same host, because they share more than messages.
void checkTogether(const Experiment& e, const std::string& one, const std::string& other,
                   const std::string& why, Problems& problems) {
  const std::string here = hostOf(e, one);
  const std::string there = hostOf(e, other);
  if (here == there) return;
  const std::string& placed = e.services.contains(one) ? one : other;
  const auto text = [](const std::string& host) {
    return host.empty() ? std::string("this machine") : tomlString(host);
  };
  problems.add("services." + placed + ".host", "found " + one + " on " + text(here) + " and " +
                                                   other + " on " + text(there) +
                                                   ", allowed one host for both (" + why + ")");
}

void checkPlaces(const Experiment& e, Problems& problems) {
  for (const auto& [name, host] : e.hosts) checkHost(host, problems);
  for (const auto& [name, place] : e.services) checkPlace(e, place, problems);
  if (problems.concern("services")) return;
  if (std::ranges::any_of(e.robots, [](const RobotSpec& robot) {
        return isOnWire(robot.body) && isSimulated(robot.body);
      })) {
    checkTogether(e, "robot_bridge", "sim_svc", "simulated serial lines lead from one to the other",
                  problems);
  }
  if (isPainted(e.camera)) {
    checkTogether(e, "tracker_svc", "sim_svc", "the simulated camera's pictures are no messages",
                  problems);
  }
  if (isFilmed(e.camera) && !hostOf(e, "tracker_svc").empty()) {
    problems.add("camera.record", "found true with tracker_svc on host " +
                                      tomlString(hostOf(e, "tracker_svc")) +
                                      ", allowed with tracker_svc on this machine: films stay on "
                                      "the machine of the tracker");
  }
}

void checkLink(const Experiment& e, Problems& problems) {
  if (!hasHosts(e)) return;
  if (e.link.join == JoinBy::kMulticast) {
    if (e.network.ttl < 1) {
      problems.add("network.ttl", "found 0, needed for link.join = \"multicast\": at least 1");
    } else if (!e.link.unsecured) {
      problems.add("link",
                   "found join = \"multicast\", which nothing can secure, allowed with "
                   "link.unsecured = true: anybody on that network can then drive the robots");
    }
    return;
  }
  if (e.link.security.empty() && !e.link.unsecured) {
    problems.add("link",
                 "found services on other hosts without DDS Security, allowed with "
                 "link.security = \"FOLDER\" (docs/security.md), or with link.unsecured = "
                 "true: anybody on that network can then drive the robots");
  }
  if (e.gateway.ros && e.link.domain == e.gateway.domain) {
    problems.add("link.domain", "found " + std::to_string(e.link.domain) +
                                    ", which is gateway.domain, allowed another one");
  }
}

bool isIpv4Address(const std::string& address) {
  std::array<unsigned char, sizeof(in_addr)> bytes{};
  return inet_pton(AF_INET, address.c_str(), bytes.data()) == 1 &&
         address.find('\0') == std::string::npos;
}

/// The gateway writes addresses into the configuration of Cyclone DDS, an XML document
/// (dds_gateway/dds/configuration.cpp), and takes no other ones.
void checkDdsAddress(const std::string& path, const std::string& address, Problems& problems) {
  if (isIpv4Address(address) || problems.concern(path)) return;
  problems.add(path, "found " + tomlString(address) +
                         ", allowed an IPv4 address in numbers, as \"192.168.1.20\"; \"ip addr\" "
                         "lists those of a machine");
}

void checkDdsAddresses(const Experiment& e, Problems& problems) {
  const auto check_if_given = [&](const std::string& path, const std::string& address) {
    if (!address.empty()) checkDdsAddress(path, address, problems);
  };
  check_if_given("gateway.address", e.gateway.address);
  for (std::size_t i = 0; i < e.gateway.peers.size(); ++i) {
    checkDdsAddress("gateway.peers[" + std::to_string(i) + "]", e.gateway.peers[i], problems);
  }
  check_if_given("link.address", e.link.address);
  for (const auto& [name, host] : e.hosts) {
    check_if_given("hosts." + name + ".address", host.address);
  }
}

void checkOwnConfiguration(const Gateway& gateway, Problems& problems) {
  if (gateway.configuration.empty()) return;
  const char* other = !gateway.address.empty()    ? "gateway.address"
                      : !gateway.peers.empty()    ? "gateway.peers"
                      : !gateway.security.empty() ? "gateway.security"
                                                  : nullptr;
  if (other == nullptr) return;
  problems.add("gateway.configuration",
               "found " + tomlString(gateway.configuration) + " next to " + other +
                   ", allowed one of the two: a file of yours says it all");
}

/// A configuration of Cyclone DDS can load libraries and write files.
void refuseConfigurationInFile(const Gateway& gateway, Problems& problems) {
  if (gateway.configuration.empty()) return;
  problems.add("gateway.configuration",
               "found " + tomlString(gateway.configuration) +
                   ", which can run code, allowed on the command line only: --dds-configuration "
                   "FILE (docs/security.md)");
}

}  // namespace

void checkGateway(const Experiment& e, Problems& problems) {
  const Gateway& gateway = e.gateway;
  checkOwnConfiguration(gateway, problems);
  if (gateway.configuration.empty() && gateway.address.empty()) {
    const char* key = !gateway.peers.empty()      ? "gateway.peers"
                      : !gateway.security.empty() ? "gateway.security"
                                                  : nullptr;
    if (key != nullptr) {
      problems.add(key, "found without gateway.address, which says the network interface to use");
    }
  }
  const bool leaves = !gateway.address.empty() || !gateway.configuration.empty();
  if (gateway.commands && leaves && gateway.security.empty() && !gateway.unsecured_commands) {
    problems.add("gateway.commands",
                 "found true with ROS 2 on other machines and no DDS Security, allowed with "
                 "gateway.security = \"FOLDER\" (docs/security.md), or with "
                 "gateway.unsecured_commands = true: anybody on that network can then drive the "
                 "robots");
  }
}

namespace {

bool isNumericAddress(const std::string& address) {
  std::array<unsigned char, sizeof(in6_addr)> bytes{};
  return isIpv4Address(address) || inet_pton(AF_INET6, address.c_str(), bytes.data()) == 1;
}

void checkDashboard(const Dashboard& dashboard, Problems& problems) {
  if (!dashboard.address.empty() && !isNumericAddress(dashboard.address)) {
    problems.add("dashboard.address",
                 "found " + tomlString(dashboard.address) +
                     ", allowed \"\" (this machine only) or an address in numbers, as "
                     "\"192.168.0.5\"; \"ip addr\" lists those of this machine");
  }
  if (dashboard.control_from_elsewhere && isLocalOnly(dashboard)) {
    problems.add("dashboard.control_from_elsewhere",
                 "found true with a page that only this machine sees, needed for it: "
                 "dashboard.address");
  }
}

void checkCommandRobots(const ExperimentForm& form, Problems& problems) {
  const std::vector<std::int32_t>& ids = form.common.gateway.command_robots;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const bool known = std::ranges::any_of(form.robots, [&](const RobotEntry& entry) {
      return ids[i] >= entry.id && ids[i] < entry.id + entry.count;
    });
    if (known) continue;
    problems.add("gateway.command_robots[" + std::to_string(i) + "]",
                 "found " + std::to_string(ids[i]) + ", allowed the id of a robot");
  }
}

void checkPlacesAndLink(const ExperimentForm& form, Problems& problems) {
  if (problems.concern("hosts") || problems.concern("services")) return;
  // The form has entries of robots; checkPlaces() needs only their bodies.
  Experiment e = form.common;
  for (const RobotEntry& entry : form.robots) {
    RobotSpec robot;
    robot.body = entry.body;
    e.robots.push_back(robot);
  }
  checkPlaces(e, problems);
  if (!problems.concern("link") && !problems.concern("services")) checkLink(e, problems);
}

}  // namespace

void checkNetworks(const ExperimentForm& form,
                   const std::optional<std::filesystem::path>& directory, Problems& problems) {
  if (directory) refuseConfigurationInFile(form.common.gateway, problems);
  if (!problems.concern("gateway")) {
    checkGateway(form.common, problems);
    if (!problems.concern("robots")) checkCommandRobots(form, problems);
  }
  if (!problems.concern("dashboard")) checkDashboard(form.common.dashboard, problems);
  checkPlacesAndLink(form, problems);
  checkDdsAddresses(form.common, problems);
}

}  // namespace lab::keys
