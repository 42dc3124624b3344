/// Subscriptions to ROS 2 topics.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "dds_gateway/dds/endpoint.hpp"
#include "dds_gateway/ros/command_arbiter.hpp"
#include "dds_gateway/ros/ros_type.hpp"

namespace lab::gateway {

/// One topic of commands with its counts.
class RosSubscription {
 public:
  /// Limit of messages per second; messages beyond it are counted as refused.
  static constexpr std::int64_t kMostASecond = 1000;
  static constexpr int kDepth = 256;  ///< samples that may wait between two reads

  RosSubscription(const dds::Domain& domain, const ros::RosType& type, std::string topic,
                  dds::Qos qos, const EventDescriptor& waker)
      : topic_(std::move(topic)),
        type_name_(type.descriptor->m_typename),
        reader_(domain, *type.descriptor, ros::topicName(topic_), deep(std::move(qos)), waker) {}
  RosSubscription(const RosSubscription&) = delete;
  RosSubscription& operator=(const RosSubscription&) = delete;
  virtual ~RosSubscription() = default;

  /// Acts on the newest message of each publisher. @return whether more may be waiting
  virtual bool read() = 0;

  /// Call it once a second.
  void newSecond() { this_second_ = 0; }

  [[nodiscard]] const std::string& topic() const { return topic_; }
  [[nodiscard]] const std::string& typeName() const { return type_name_; }
  [[nodiscard]] const dds::Reader& reader() const { return reader_; }
  [[nodiscard]] std::int64_t count(Answer answer) const {
    return answers_[static_cast<std::size_t>(answer)];
  }
  /// Messages that a newer one of the same publisher replaced before they were read.
  [[nodiscard]] std::int64_t superseded() const { return superseded_; }

 protected:
  static dds::Qos deep(dds::Qos qos) {
    qos.depth = kDepth;
    return qos;
  }
  void countArrival(bool replaces) {
    const bool flood = ++this_second_ > kMostASecond;
    if (flood) note(Answer::kFlood);
    if (replaces && !flood) ++superseded_;
  }
  void note(Answer answer) { ++answers_[static_cast<std::size_t>(answer)]; }
  dds::Reader& arrivals() { return reader_; }

 private:
  std::string topic_;
  std::string type_name_;
  dds::Reader reader_;
  std::array<std::int64_t, kAnswers> answers_{};
  std::int64_t superseded_ = 0;
  std::int64_t this_second_ = 0;
};

/// A subscription to one type of message. `Value` is the part that is kept; the message itself is
/// valid only during the read.
template <class Message, class Value>
class TypedRosSubscription final : public RosSubscription {
 public:
  using Keep = std::function<Value(const Message&)>;
  using Act = std::function<Answer(dds::WriterId, const Value&)>;

  TypedRosSubscription(const dds::Domain& domain, const std::string& topic, const dds::Qos& qos,
                       const EventDescriptor& waker, Keep keep, Act act)
      : RosSubscription(domain, ros::rosType<Message>(), topic, qos, waker),
        keep_(std::move(keep)),
        act_(std::move(act)) {}

  bool read() override {
    newest_.clear();
    const int taken = arrivals().take(kDepth, [this](const void* sample, dds::WriterId writer) {
      const auto& message = *static_cast<const Message*>(sample);
      const auto before = std::find_if(newest_.begin(), newest_.end(),
                                       [writer](auto& other) { return other.first == writer; });
      countArrival(before != newest_.end());
      if (before != newest_.end()) {
        before->second = keep_(message);
      } else {
        newest_.emplace_back(writer, keep_(message));
      }
    });
    for (const auto& [writer, value] : newest_) note(act_(writer, value));
    return taken == kDepth;
  }

 private:
  Keep keep_;
  Act act_;
  std::vector<std::pair<dds::WriterId, Value>> newest_;
};

}  // namespace lab::gateway
