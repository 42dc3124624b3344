/// The service that connects the lab's bus to ROS 2 and to the buses of other hosts.
#pragma once

#include <memory>
#include <optional>

#include "common/service/service_main.hpp"
#include "dds_gateway/link/bus_link.hpp"
#include "dds_gateway/ros/ros_bridge.hpp"

namespace lab::gateway {

class GatewayService final : public Service {
 public:
  /// @param link set if this host joins the buses of several hosts
  /// @throws ExperimentError if DDS cannot use a value of the experiment
  GatewayService(const ServiceContext& context, const std::optional<BusLinkOptions>& link);

  [[nodiscard]] bool isForwarding() override { return link_ && link_->isForwarding(); }

 private:
  std::unique_ptr<RosBridge> ros_;
  std::unique_ptr<BusLink> link_;
};

/// The service as a process; it does not run in virtual time.
[[nodiscard]] ServiceDescription serviceDescription();

}  // namespace lab::gateway
