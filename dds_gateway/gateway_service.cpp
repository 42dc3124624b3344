#include "dds_gateway/gateway_service.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "common/experiment/experiment_file.hpp"
#include "common/experiment/service_placement.hpp"
#include "dds_gateway/dds/error.hpp"

namespace lab::gateway {
namespace {

constexpr const char* kName = "dds_gateway";

/// Options of the command line for the link.
struct LinkArguments {
  std::string host;
  std::string address;
  std::vector<std::string> peers;
  std::string key;

  void addTo(CLI::App& app) {
    app.add_option("--link-host", host, "Join buses: this host's name in the experiment");
    app.add_option("--link-address", address, "Address of this host as the other hosts reach it");
    app.add_option("--link-peer", peers, "Address of another host")->take_all();
    app.add_option("--link-key", key, "Key of the run: separates runs");
  }

  [[nodiscard]] std::optional<BusLinkOptions> options(const ServiceContext& context) const {
    if (host.empty()) return std::nullopt;
    const Link& link = context.experiment.link;
    BusLinkOptions options;
    options.host = host;
    options.address = address;
    options.peers = peers;
    options.key = key;
    options.domain = link.domain;
    options.max_offset = link.max_clock_offset;
    if (!link.security.empty()) options.security = (context.directory / link.security).string();
    return options;
  }
};

/// With several hosts only one gateway serves ROS 2: that of the host where the experiment places
/// dds_gateway.
bool servesRos(const Experiment& experiment, const std::optional<BusLinkOptions>& link) {
  if (!experiment.gateway.ros) return false;
  if (!link) return true;
  const std::string place = hostOf(experiment, kName);
  if (!place.empty()) return link->host == place;
  const std::vector<std::string> others = otherHosts(experiment);
  return std::find(others.begin(), others.end(), link->host) == others.end();
}

}  // namespace

GatewayService::GatewayService(const ServiceContext& context,
                               const std::optional<BusLinkOptions>& link) {
  if (servesRos(context.experiment, link)) ros_ = std::make_unique<RosBridge>(context);
  try {
    if (link) {
      link_ = std::make_unique<BusLink>(context.node, context.loop, context.descriptors, *link);
    }
  } catch (const dds::DdsError& error) {
    throw ExperimentError({std::string("link: ") + error.what()});
  }
  context.loop.soon([&node = context.node] { node.ready(); });
}

ServiceDescription serviceDescription() {
  ServiceDescription description;
  description.name = kName;
  description.summary = "Connects the lab to ROS 2, and its bus to those of other hosts";
  const auto arguments = std::make_shared<LinkArguments>();
  const auto sources = std::make_shared<CommandLineSources>();
  description.add_options = [arguments, sources](CLI::App& app) {
    arguments->addTo(app);
    app.add_option("--dds-configuration", sources->dds_configuration,
                   "Cyclone DDS configuration (XML) to use instead of the lab's own, relative to "
                   "the experiment file");
  };
  description.sources = [sources] { return *sources; };
  description.make = [arguments](const ServiceContext& context) -> std::unique_ptr<Service> {
    return std::make_unique<GatewayService>(context, arguments->options(context));
  };
  return description;
}

}  // namespace lab::gateway
