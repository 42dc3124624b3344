/// What ROS 2 may ask of the lab (docs/ros2.md).
#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "common/service/service_main.hpp"
#include "dds_gateway/dds/domain.hpp"
#include "dds_gateway/dds/waker.hpp"
#include "dds_gateway/ros/command_arbiter.hpp"
#include "dds_gateway/ros/ros_subscription.hpp"
#include "dds_gateway/ros/light_arbiter.hpp"
#include "dds_gateway/ros/topic_mapping.hpp"
#include "dds_gateway/ros/ros_names.hpp"
#include "dds_gateway/ros/to_ros.hpp"

namespace lab::gateway {

/// Readers for the commands, the two desks that decide, and the lab's messages that follow.
class RosCommands {
 public:
  /// @throws DdsError
  RosCommands(const ServiceContext& context, const dds::Domain& domain, Mapping& mapping,
              const Names& names);

  /// To be called once a second, whoever listens: floods are counted by it, refusals reported.
  void everySecond();

  void addTo(Diagnostics& diagnostics);

  [[nodiscard]] const std::list<std::unique_ptr<Inlet>>& inlets() const { return inlets_; }

 private:
  void openRobot(Mapping& mapping, std::int32_t robot);
  void openLab(Mapping& mapping);
  template <class Message, class Value>
  void open(Mapping& mapping, const std::string& topic, const dds::Qos& qos,
            std::function<Value(const Message&)> keep,
            std::function<Answer(dds::WriterId, const Value&)> act);
  void watch();
  void look();
  void send();
  Answer program(std::int32_t robot, dds::WriterId writer, const std::string& name);

  Node& node_;
  Loop& loop_;
  Descriptors& descriptors_;
  const Experiment& experiment_;
  const dds::Domain& domain_;
  Names names_;
  CommandDesk desk_;
  LightDesk light_;
  robot_order_t table_;  ///< the experiment's, without its bands
  dds::Waker waker_;
  std::list<std::unique_ptr<Inlet>> inlets_;
  std::unique_ptr<Descriptors::Watch> watch_;
};

}  // namespace lab::gateway
