#include "common/experiment/service_placement.hpp"

#include <algorithm>
#include <set>

namespace lab {
namespace {

bool anyRobot(const Experiment& experiment, bool (*fits)(Body)) {
  return std::ranges::any_of(experiment.robots,
                             [fits](const RobotSpec& robot) { return fits(robot.body); });
}

bool joinsHosts(const Experiment& experiment) {
  return experiment.link.join == JoinBy::kDds && !otherHosts(experiment).empty();
}

}  // namespace

bool waitsForEstimates(const Experiment& experiment) {
  return !experiment.stop_when.empty() ||
         std::ranges::any_of(experiment.light.steps,
                             [](const LightStep& step) { return !step.until.estimate.empty(); });
}

bool needsCrowd(const Experiment& experiment) {
  const bool stops = std::ranges::any_of(
      experiment.stop_when, [](const StopRule& rule) { return !rule.until.observable.empty(); });
  return stops || std::ranges::any_of(experiment.light.steps, [](const LightStep& step) {
           return !step.until.observable.empty() ||
                  std::ranges::any_of(step.layers,
                                      [](const LayerSpec& layer) { return layer.crowd.given(); });
         });
}

bool isDispensable(const Experiment& experiment, std::string_view service) {
  if (service == "analyzer") return !waitsForEstimates(experiment) && !needsCrowd(experiment);
  if (service == "dds_gateway") return !experiment.gateway.commands && !joinsHosts(experiment);
  return service == kObserverService;
}

bool isNeeded(const Experiment& experiment, std::string_view service) {
  if (service == "robot_bridge") return anyRobot(experiment, isOnWire);
  if (service == "tracker_svc") return experiment.camera.tracker == Tracker::kCamera;
  if (service == "sim_svc") {
    return anyRobot(experiment, [](Body body) { return body != Body::kSerial; });
  }
  if (service == "dds_gateway") {
    return experiment.gateway.ros || joinsHosts(experiment);
  }
  return true;
}

std::vector<std::string> neededServices(const Experiment& experiment) {
  std::vector<std::string> names;
  for (const std::string_view name : kServiceNames) {
    if (isNeeded(experiment, name)) names.emplace_back(name);
  }
  return names;
}

bool usesPorts(std::string_view service) {
  return service == "robot_bridge" || service == "tracker_svc" || service == "sim_svc";
}

std::vector<std::string> hostsInUse(const Experiment& experiment) {
  std::set<std::string> hosts;
  for (const std::string& name : neededServices(experiment)) {
    hosts.insert(hostOf(experiment, name));
  }
  hosts.erase("");
  return {hosts.begin(), hosts.end()};
}

bool isLinkedByDds(const Experiment& experiment) {
  return experiment.link.join == JoinBy::kDds && !hostsInUse(experiment).empty();
}

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
