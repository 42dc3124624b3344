#include "runner/virtual_time/services.hpp"

#include <set>

#include "analyzer/analyzer_service.hpp"
#include "common/experiment/service_placement.hpp"
#include "dds_gateway/gateway_service.hpp"
#include "projector_ctl/projector_service.hpp"
#include "robot_bridge/bridge_service.hpp"
#include "sim_svc/sim_service.hpp"
#include "tracker_svc/tracker_service.hpp"

namespace lab::runner {

std::vector<ServiceDescription> labServices(const Experiment& experiment) {
  std::vector<ServiceDescription> services = {
      analysis::serviceDescription(), projector::serviceDescription(),
      bridge::serviceDescription(),   tracker::serviceDescription(),
      sim::serviceDescription(),      gateway::serviceDescription()};
  std::erase_if(services, [&](const auto& service) { return !service.isNeededFor(experiment); });
  return services;
}

std::vector<std::string> hostsInUse(const Experiment& experiment) {
  std::set<std::string> hosts;
  for (const ServiceDescription& service : labServices(experiment)) {
    hosts.insert(hostOf(experiment, service.name));
  }
  hosts.erase("");
  return {hosts.begin(), hosts.end()};
}

}  // namespace lab::runner
