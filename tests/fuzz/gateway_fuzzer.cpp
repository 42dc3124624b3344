// The gateway's parts without DDS: commands of ROS 2 publishers, messages of the lab on their way
// to ROS 2, packets and heartbeats of other gateways, rules for topics.
#include <array>
#include <cstdint>
#include <lab/analysis_t.hpp>
#include <lab/light_status_t.hpp>
#include <lab/robot_command_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/robot_stop_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/message_header.hpp"
#include "common/experiment/light_messages.hpp"
#include "common/files/experiment_error.hpp"
#include "dds_gateway/link/held_packets.hpp"
#include "dds_gateway/link/link_core.hpp"
#include "dds_gateway/link/link_peers.hpp"
#include "dds_gateway/ros/command_arbiter.hpp"
#include "dds_gateway/ros/from_ros.hpp"
#include "dds_gateway/ros/light_arbiter.hpp"
#include "dds_gateway/ros/ros_names.hpp"
#include "dds_gateway/ros/to_ros.hpp"
#include "dds_gateway/ros/topic_mapping.hpp"
#include "tests/fuzz/input.hpp"
#include "tests/fuzz/messages.hpp"

namespace lab::fuzz {
namespace {

using namespace gateway;

constexpr int kMostSteps = 200;
constexpr std::int64_t kStart = 946'684'800'000'000;

template <class Message>
Message messageFrom(Input& input) {
  Message message{};
  read(input, message);
  return message;
}

void runCommands(Input& input) {
  CommandArbiter robots({1, 2, 7}, {0.27, 0.075}, 500'000);
  LightArbiter light(500'000);
  std::int64_t now = kStart;
  for (int step = 0; step < kMostSteps && !input.empty(); ++step) {
    const auto what = input.number<std::uint8_t>();
    const dds::WriterId writer = 1U + what / 8U % 4U;
    const std::vector<std::int32_t> ids{input.number<std::int8_t>(), 1};
    switch (what % 8) {
      case 0: {
        const ros::Twist twist{{input.number<double>(), 0, 0}, {0, 0, input.number<double>()}};
        static_cast<void>(robots.drive(ids.front(), writer, twist, now));
        break;
      }
      case 1:
        static_cast<void>(robots.command(ids, writer, messageFrom<robot_order_t>(input), now));
        break;
      case 2:
        static_cast<void>(robots.release(ids, writer, now));
        break;
      case 3:
        robots.take(messageFrom<robot_command_t>(input), now);
        break;
      case 4:
        robots.take(messageFrom<robot_status_t>(input));
        break;
      case 5:
        robots.take(messageFrom<robot_stop_t>(input), now);
        break;
      case 6: {
        const auto intensity = input.number<double>();
        const auto hold = input.number<double>();
        static_cast<void>(light.show(writer, intensity, hold, input.cText(what / 8U), now));
        break;
      }
      default:
        static_cast<void>(light.release(writer, now));
    }
    now += input.number<std::uint8_t>() * std::int64_t{10'000};
    robots.tick(now);
    for (const robot_command_t& command : robots.due(now)) static_cast<void>(encode(command));
    if (const auto command = light.due(now)) static_cast<void>(encode(*command));
  }
}

void convert(Input& input) {
  const RobotMessages messages("lab/arena", "lab/robot1");
  AnalysisMessage analysis("lab/arena");
  LightGrid grid(1.2, 0.9, "lab/arena");
  const auto frame = messageFrom<tracked_frame_t>(input);
  static_cast<void>(stampOf(frame.utime));
  for (const tracked_pose_t& pose : frame.robots) {
    static_cast<void>(messages.pose(frame.utime, pose));
    static_cast<void>(messages.odometry(frame.utime, pose, nullptr));
    static_cast<void>(messages.transform(frame.utime, pose));
  }
  for (const robot_state_t& state : messageFrom<robot_status_t>(input).robots) {
    static_cast<void>(messages.light(state, LightSensor::kMean));
  }
  const auto result = messageFrom<analysis_t>(input);
  static_cast<void>(analysis.make(result, result.program.name));
  const light::Field field = toField(messageFrom<light_status_t>(input));
  if (!light::validate(field.layers) && !light::validate(field.previous)) {
    static_cast<void>(grid.paint(light::CompiledField(field), frame.utime, frame.utime));
  }
  std::string text = input.restAsText();
  static_cast<void>(namePart(text));
  static_cast<void>(isTopicName(text));
  static_cast<void>(sanitizedText(text));
}

/// The packets of hosts whose clock is not known, with bounds that inputs reach.
class Held {
 public:
  void add(const std::string& host, HeldPacket packet) {
    packets_.add(host, std::move(packet));
    require(packets_.bytes() <= kMostBytes);
  }

  /// As BusLink does: what is left of a host is passed on once its clock is known.
  void release(std::int64_t now, const LinkPeers& peers, LinkCore& core) {
    for (const auto& [host, peer] : peers.all()) {
      if (peer.state == PeerState::kNew || peer.state == PeerState::kSilent) continue;
      for (const HeldPacket& packet : packets_.take(host)) {
        static_cast<void>(core.receive(now, host, packet.gateway, packet.stream, packet.number,
                                       now - packet.heard, packet.channel, packet.data));
      }
    }
  }

  void takeAll() {
    for (const char* host : {"a", "b", "c", "d"}) static_cast<void>(packets_.take(host));
    require(packets_.bytes() == 0);
  }

 private:
  static constexpr std::size_t kMostBytes = 2000;
  static constexpr std::size_t kMostHosts = 3;
  HeldPackets packets_{kMostHosts, kMostBytes};
};

void runLink(Input& input) {
  LinkCore core(7);
  LinkPeers peers("here", 7, ProtocolVersion::own(), 0.01);
  Held held;
  std::int64_t now = kStart;
  for (int step = 0; step < kMostSteps && !input.empty(); ++step) {
    const auto what = input.number<std::uint8_t>();
    const std::string host(1, static_cast<char>('a' + what / 4 % 4));
    const std::int64_t gateway = input.number<std::int8_t>();
    if (what % 4 == 0) {
      LinkHeartbeat heartbeat{host, gateway, ProtocolVersion::own(), 0, 0, 0, 0, {}};
      heartbeat.to = input.number<std::int8_t>();
      heartbeat.sent = what / 16 % 2 != 0 ? now - 1000 : input.number<std::int64_t>();
      heartbeat.there = input.number<std::int64_t>();
      heartbeat.answered = input.number<std::int64_t>();
      heartbeat.refusal = input.cText(what / 16U);
      LinkHeartbeat answer;
      static_cast<void>(peers.hear(now, heartbeat, answer));
    } else {
      const TimedMessage message = nextMessage(input);
      static_cast<void>(peekHeader(message.data));
      static_cast<void>(LinkCore::isStop(message.channel, message.data));
      if (what % 4 == 1) {
        static_cast<void>(core.hear(now, message.channel, message.data));
      } else {
        const auto stream = input.number<std::int32_t>();
        const auto number = input.number<std::int64_t>();
        static_cast<void>(core.receive(now, host, gateway, stream, number,
                                       input.number<std::int32_t>(), message.channel,
                                       message.data));
        peers.alive(now, host, gateway);
        held.add(host, {gateway, stream, number, now, std::string(message.channel), message.data});
      }
      static_cast<void>(core.counts(host));
    }
    now += input.number<std::uint8_t>() * std::int64_t{10'000};
    static_cast<void>(peers.tick(now));
    held.release(now, peers, core);
  }
  held.takeAll();
}

void readRules(Input& input) {
  try {
    TopicMapping mapping(input.restAsText(), "rules.toml");
    for (const char* topic : {"/lab/robot1/pose", "/lab/light_field", "/tf"}) {
      static_cast<void>(mapping.route(topic));
    }
  } catch (const std::runtime_error&) {  // also what route() throws
  }
}

}  // namespace
}  // namespace lab::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  lab::fuzz::Input input(bytes, size);
  switch (input.number<char>()) {
    case 'c':
      lab::fuzz::runCommands(input);
      break;
    case 'l':
      lab::fuzz::runLink(input);
      break;
    case 'r':
      lab::fuzz::readRules(input);
      break;
    default:
      lab::fuzz::convert(input);
  }
  return 0;
}
