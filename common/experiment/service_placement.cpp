#include "common/experiment/service_placement.hpp"

#include <set>

namespace lab {

std::string hostOf(const Experiment& experiment, std::string_view service) {
  const auto place = experiment.services.find(std::string(service));
  return place == experiment.services.end() ? std::string() : place->second.host;
}

std::vector<std::string> otherHosts(const Experiment& experiment) {
  std::set<std::string> hosts;
  for (const auto& [service, place] : experiment.services) {
    if (!place.host.empty()) hosts.insert(place.host);
  }
  return {hosts.begin(), hosts.end()};
}

HostSpec hostSpec(const Experiment& experiment, const std::string& host) {
  const auto known = experiment.hosts.find(host);
  HostSpec spec;
  if (known != experiment.hosts.end()) spec = known->second;
  spec.name = host;
  if (spec.ssh.empty()) spec.ssh = host;
  return spec;
}

bool isLocalOnly(const Dashboard& dashboard) {
  const std::string& address = dashboard.address;
  return address.empty() || address.starts_with("127.") || address == "::1";
}

}  // namespace lab
