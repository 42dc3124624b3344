/// The state of the lab's services and of the gateway's topics: /diagnostics.
#pragma once

#include <cstdint>
#include <lab/service_status_t.hpp>
#include <map>
#include <string>

#include "dds_gateway/ros/foreign_endpoints.hpp"
#include "dds_gateway/ros/ros_commands.hpp"
#include "dds_gateway/ros/ros_names.hpp"
#include "dds_gateway/ros/ros_publisher.hpp"
#include "dds_gateway/ros/to_ros.hpp"

namespace lab::gateway {

/// Collects the status of services and topics, and makes a diagnostic_msgs/DiagnosticArray of it.
class GatewayDiagnostics {
 public:
  /// The arguments outlive this object.
  GatewayDiagnostics(const RosNames& names, RosPublishers& publishers,
                     const ForeignEndpoints& foreign)
      : names_(names), publishers_(publishers), foreign_(foreign) {}

  /// @param now [us since 1970] time of arrival
  void take(const service_status_t& status, std::int64_t now);

  /// Cyclone's last warnings; shown until there are newer ones.
  void setWarnings(std::string warnings) { warnings_ = std::move(warnings); }

  /// @param now [us since 1970]
  /// @param refused_robots messages of robots beyond the limit
  /// @param commands null: commands from ROS 2 are off
  /// @return a message that points at memory of `diagnostics`
  [[nodiscard]] const ros::DiagnosticArray& make(Diagnostics& diagnostics, std::int64_t now,
                                                 std::int64_t refused_robots,
                                                 RosCommands* commands);

 private:
  struct ReceivedStatus {
    service_status_t status;
    std::int64_t utime = 0;  ///< of its arrival
  };

  void addServices(Diagnostics& diagnostics, std::int64_t now) const;
  void addTopics(Diagnostics& diagnostics, std::int64_t now, std::int64_t refused_robots);

  const RosNames& names_;
  RosPublishers& publishers_;
  const ForeignEndpoints& foreign_;
  std::map<std::string, ReceivedStatus> services_;  ///< by sender
  std::string warnings_;
};

}  // namespace lab::gateway
