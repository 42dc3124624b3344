/// Commands from ROS 2 (docs/ros2.md).
#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "common/process/event_descriptor.hpp"
#include "common/service/service_main.hpp"
#include "dds_gateway/dds/domain.hpp"
#include "dds_gateway/ros/command_arbiter.hpp"
#include "dds_gateway/ros/light_arbiter.hpp"
#include "dds_gateway/ros/ros_names.hpp"
#include "dds_gateway/ros/ros_subscription.hpp"
#include "dds_gateway/ros/to_ros.hpp"
#include "dds_gateway/ros/topic_mapping.hpp"

namespace lab::gateway {

/// Reads the commands, lets the arbiters decide, and sends the resulting messages on the lab's bus.
class RosCommands {
 public:
  /// @throws DdsError
  RosCommands(const ServiceContext& context, const dds::Domain& domain, TopicMapping& mapping,
              const RosNames& names);

  /// Call it once a second: restarts the count of messages per second and reports refusals.
  void everySecond();

  void addTo(Diagnostics& diagnostics);

  [[nodiscard]] const std::list<std::unique_ptr<RosSubscription>>& rosSubscriptions() const {
    return ros_subscriptions_;
  }

 private:
  void openRobot(TopicMapping& mapping, std::int32_t robot);
  void openLab(TopicMapping& mapping);
  template <class Message, class Value>
  void open(TopicMapping& mapping, const std::string& topic, const dds::Qos& qos,
            std::function<Value(const Message&)> keep,
            std::function<Answer(dds::WriterId, const Value&)> act);
  void watch();
  void look();
  void send();
  /// @param name of a program, or the text of one (docs/programs.md), which has several lines
  Answer program(std::int32_t robot, dds::WriterId writer, const std::string& name);
  Answer load(std::int32_t robot, dds::WriterId writer, const std::string& text);
  Answer run(std::int32_t robot, dds::WriterId writer, const Program& program);

  Node& node_;
  Loop& loop_;
  DescriptorWatcher& descriptors_;
  const Experiment& experiment_;
  const dds::Domain& domain_;
  RosNames names_;
  CommandArbiter arbiter_;
  LightArbiter light_;
  robot_order_t table_;  ///< the experiment's light table, without its bands
  EventDescriptor waker_;
  std::list<std::unique_ptr<RosSubscription>> ros_subscriptions_;
  std::unique_ptr<DescriptorWatcher::Watch> watch_;
};

}  // namespace lab::gateway
