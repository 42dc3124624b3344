/// Publishers of ROS 2 topics.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "dds_gateway/dds/endpoint.hpp"
#include "dds_gateway/ros/rate_limit.hpp"
#include "dds_gateway/ros/ros_type.hpp"
#include "dds_gateway/ros/topic_mapping.hpp"

namespace lab::gateway {

/// One topic with its writer and its counts.
class RosPublisher {
 public:
  RosPublisher(const dds::Domain& domain, const ros::RosType& type, const Route& route,
               const dds::Qos& qos)
      : topic_(route.topic),
        type_name_(type.descriptor->m_typename),
        limit_(route.rate),
        writer_(domain, *type.descriptor, ros::topicName(route.topic), qos) {}

  /// Whether the rate limit lets a message of this time pass; counts it as offered.
  [[nodiscard]] bool admit(std::int64_t utime) {
    ++offered_;
    if (!limit_.admit(utime)) return false;
    utime_ = utime;
    return true;
  }
  void write(const void* message) { writer_.write(message); }

  [[nodiscard]] const std::string& topic() const { return topic_; }
  [[nodiscard]] const std::string& typeName() const { return type_name_; }
  [[nodiscard]] std::int64_t offered() const { return offered_; }
  [[nodiscard]] std::int64_t thinned() const {
    return offered_ - writer_.written() - writer_.timeouts();
  }
  [[nodiscard]] const dds::Writer& writer() const { return writer_; }
  [[nodiscard]] std::int64_t lastUtime() const { return utime_; }

 private:
  std::string topic_;
  std::string type_name_;
  RateLimit limit_;
  dds::Writer writer_;
  std::int64_t offered_ = 0;
  std::int64_t utime_ = 0;
};

/// Makes publishers by the topic mapping. Returns null for a topic that the mapping denies or that
/// cannot be made.
class RosPublishers {
 public:
  RosPublishers(const dds::Domain& domain, TopicMapping& mapping)
      : domain_(domain), mapping_(mapping) {}

  using Handle = std::shared_ptr<RosPublisher>;  ///< ends with its last owner

  template <class Message>
  [[nodiscard]] Handle open(const std::string& topic, const dds::Qos& qos) {
    return open(ros::rosType<Message>(), topic, qos);
  }
  template <class Message>
  [[nodiscard]] Handle open(const std::string& topic) {
    return open<Message>(topic, ros::defaultQos(ros::rosType<Message>()));
  }
  /// A publisher whose last message late joiners receive.
  template <class Message>
  [[nodiscard]] Handle openLatched(const std::string& topic) {
    return open<Message>(topic, ros::latchedQos(ros::rosType<Message>()));
  }

  /// The publishers in use, in the order of their creation.
  [[nodiscard]] std::vector<Handle> all();

  /// Why the last failed topic could not be made; empty: none failed.
  [[nodiscard]] const std::string& trouble() const { return trouble_; }

 private:
  Handle open(const ros::RosType& type, const std::string& topic, const dds::Qos& qos) {
    try {
      const std::optional<Route> route = mapping_.route(topic);
      if (!route) return nullptr;
      auto publisher = std::make_shared<RosPublisher>(domain_, type, *route, qos);
      made_.push_back(publisher);
      return publisher;
    } catch (const std::runtime_error& error) {  // concerns one topic; the others continue
      trouble_ = error.what();
      return nullptr;
    }
  }

  const dds::Domain& domain_;
  TopicMapping& mapping_;
  std::string trouble_;
  std::vector<std::weak_ptr<RosPublisher>> made_;
};

inline std::vector<RosPublishers::Handle> RosPublishers::all() {
  std::erase_if(made_, [](const auto& publisher) { return publisher.expired(); });
  std::vector<Handle> open;
  open.reserve(made_.size());
  for (const auto& publisher : made_) {
    if (Handle handle = publisher.lock()) open.push_back(std::move(handle));
  }
  return open;
}

}  // namespace lab::gateway
