#include "dds_gateway/ros/ros_commands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/experiment/experiment_messages.hpp"
#include "common/experiment/program_messages.hpp"
#include "common/files/experiment_error.hpp"
#include "common/math/units.hpp"
#include "common/programs/program_file.hpp"

namespace lab::gateway {
namespace {

constexpr std::int64_t kTick_us = 20'000;
constexpr std::int64_t kPause_us = 2'000;  // limits wake-ups to 500 per second during a flood
constexpr const char* kRelease = "release";
constexpr const char* kStand = "stand";

std::set<std::int32_t> drivable(const Experiment& experiment) {
  const std::vector<std::int32_t> known = commandedRobots(experiment);
  const std::vector<std::int32_t>& wanted = experiment.gateway.command_robots;
  std::set<std::int32_t> robots(known.begin(), known.end());
  if (wanted.empty()) return robots;
  std::erase_if(robots, [&wanted](std::int32_t id) {
    return std::find(wanted.begin(), wanted.end(), id) == wanted.end();
  });
  return robots;
}

robot_order_t tableOf(const Experiment& experiment) {
  robot_order_t order = lightTableCommand(experiment).orders.front();
  order.bands.clear();
  order.num_bands = 0;
  order.robot_ids.clear();
  order.num_robots = 0;
  return order;
}

robot_order_t standing() {
  robot_order_t order{};
  order.mode = robot_order_t::STAND;
  return order;
}

/// QoS of a reader that matches every publisher, reliable or not.
template <class Message>
dds::Qos anyPublisher() {
  return ros::sensorQos(ros::rosType<Message>());
}

/// For commands that are sent once: the publisher must be reliable, as ROS 2's are by default.
template <class Message>
dds::Qos reliable() {
  return ros::defaultQos(ros::rosType<Message>());
}

template <class Message>
Message unchanged(const Message& message) {
  return message;
}

}  // namespace

RosCommands::RosCommands(const ServiceContext& context, const dds::Domain& domain,
                         TopicMapping& mapping, const RosNames& names)
    : node_(context.node),
      loop_(context.loop),
      descriptors_(context.descriptors),
      experiment_(context.experiment),
      domain_(domain),
      names_(names),
      arbiter_(drivable(experiment_),
               {experiment_.hardware.max_wheel_speed, experiment_.hardware.diameter},
               units::microseconds(experiment_.gateway.command_timeout)),
      light_(units::microseconds(experiment_.gateway.command_timeout)),
      table_(tableOf(experiment_)) {
  for (const std::int32_t id : arbiter_.robots()) openRobot(mapping, id);
  openLab(mapping);
  node_.subscribe<robot_command_t>(channels::kRobotCommand, [this](const robot_command_t& command) {
    if (command.sender != node_.identity().name) arbiter_.take(command, loop_.now());
  });
  node_.subscribe<robot_stop_t>(
      channels::kRobotStop, [this](const robot_stop_t& stop) { arbiter_.take(stop, loop_.now()); });
  node_.subscribe<robot_status_t>(channels::kRobotStatus,
                                  [this](const robot_status_t& status) { arbiter_.take(status); });
  loop_.every(kTick_us, loop_.now(), [this] { send(); });
  watch();
}

template <class Message, class Value>
void RosCommands::open(TopicMapping& mapping, const std::string& topic, const dds::Qos& qos,
                       std::function<Value(const Message&)> keep,
                       std::function<Answer(dds::WriterId, const Value&)> act) {
  const std::optional<Route> route = mapping.route(topic);
  if (!route) return;
  ros_subscriptions_.push_back(std::make_unique<TypedRosSubscription<Message, Value>>(
      domain_, route->topic, qos, waker_, std::move(keep), std::move(act)));
}

void RosCommands::openRobot(TopicMapping& mapping, std::int32_t robot) {
  const std::string drive = names_.topic(robot, "cmd_vel");
  const auto act = [this, robot](dds::WriterId writer, const ros::Twist& twist) {
    return arbiter_.drive(robot, writer, twist, loop_.now());
  };
  open<ros::Twist, ros::Twist>(mapping, drive, anyPublisher<ros::Twist>(), unchanged<ros::Twist>,
                               act);
  // The stamp comes from another clock, so the age of a command counts from its arrival.
  open<ros::TwistStamped, ros::Twist>(
      mapping, drive, anyPublisher<ros::TwistStamped>(),
      [](const ros::TwistStamped& message) { return message.twist; }, act);
  open<ros::String, std::string>(
      mapping, names_.topic(robot, "program"), reliable<ros::String>(),
      [](const ros::String& message) { return std::string(message.data); },
      [this, robot](dds::WriterId writer, const std::string& name) {
        return program(robot, writer, name);
      });
}

void RosCommands::openLab(TopicMapping& mapping) {
  struct Group {
    std::uint8_t mode = 0;
    std::vector<std::int32_t> robots;
  };
  open<ros::ProgramCommand, Group>(
      mapping, names_.topic("program"), reliable<ros::ProgramCommand>(),
      [](const ros::ProgramCommand& message) {
        const auto& ids = message.robot_ids;
        return Group{message.mode, {ids._buffer, ids._buffer + ids._length}};
      },
      [this](dds::WriterId writer, const Group& group) {
        std::vector<std::int32_t> ids = group.robots;
        if (ids.empty()) ids.assign(arbiter_.robots().begin(), arbiter_.robots().end());
        switch (group.mode) {
          case robot_order_t::STAND:
            return arbiter_.command(ids, writer, standing(), loop_.now());
          case robot_order_t::TABLE:
            return arbiter_.release(ids, writer, loop_.now());
          default:
            return Answer::kOutOfRange;
        }
      });
  const std::string light = names_.topic("light");
  open<ros::Float64, double>(
      mapping, light, reliable<ros::Float64>(),
      [](const ros::Float64& message) { return message.data; },
      [this](dds::WriterId writer, double intensity) {
        return light_.show(writer, intensity, 0, "ROS 2", loop_.now());
      });
  struct Light {
    double intensity = 0;
    double hold = 0;
    bool release = false;
    std::string label;
  };
  open<ros::LightCommand, Light>(
      mapping, light, reliable<ros::LightCommand>(),
      [](const ros::LightCommand& message) {
        return Light{message.intensity, message.hold, message.release, message.label};
      },
      [this](dds::WriterId writer, const Light& wanted) {
        if (wanted.release) return light_.release(writer, loop_.now());
        return light_.show(writer, wanted.intensity, wanted.hold, wanted.label, loop_.now());
      });
}

Answer RosCommands::program(std::int32_t robot, dds::WriterId writer, const std::string& name) {
  if (name.empty() || name == kRelease) return arbiter_.release({robot}, writer, loop_.now());
  if (name.find('\n') != std::string::npos) return load(robot, writer, name);
  const auto known = experiment_.programs.find(name);
  if (known == experiment_.programs.end() && name == kStand) {
    return arbiter_.command({robot}, writer, standing(), loop_.now());
  }
  if (known == experiment_.programs.end()) return Answer::kNoProgram;
  return run(robot, writer, known->second);
}

Answer RosCommands::load(std::int32_t robot, dds::WriterId writer, const std::string& text) {
  if (!experiment_.gateway.load_programs) return Answer::kNoLoading;
  try {
    const auto limits = wheelLimits(experiment_.hardware);
    return run(robot, writer, toProgram(readProgram(text, "ROS 2", "ros", limits)));
  } catch (const ExperimentError& error) {
    node_.noteError(std::string("program of ROS 2 refused: ") + error.what());
    return Answer::kBadProgram;
  }
}

Answer RosCommands::run(std::int32_t robot, dds::WriterId writer, const Program& program) {
  robot_order_t order = table_;
  light_band_t everywhere{};
  everywhere.high = 1;
  everywhere.program = toMessage(program);
  order.bands = {everywhere};
  order.num_bands = 1;
  return arbiter_.command({robot}, writer, order, loop_.now());
}

void RosCommands::watch() {
  watch_ = descriptors_.watch(waker_.get(), [this] { look(); });
}

void RosCommands::look() {
  watch_.reset();
  loop_.at(loop_.now() + kPause_us, [this] { watch(); });
  waker_.clear();
  for (const auto& subscription : ros_subscriptions_) {
    if (subscription->read()) waker_.signal();
  }
  send();
}

void RosCommands::send() {
  const std::int64_t now = loop_.now();
  arbiter_.tick(now);
  for (robot_command_t& command : arbiter_.due(now)) {
    node_.publishCommand(channels::kRobotCommand, command);
  }
  if (auto light = light_.due(now)) node_.publishCommand(channels::kLightCommand, *light);
}

/// The texts contain no numbers, so that the lab's record takes each only once.
void RosCommands::everySecond() {
  for (const auto& subscription : ros_subscriptions_) {
    subscription->newSecond();
    for (int i = 0; i < kAnswers; ++i) {
      const auto answer = static_cast<Answer>(i);
      const bool fine = answer == Answer::kTaken || answer == Answer::kClamped ||
                        answer == Answer::kOwned || answer == Answer::kLabHolds ||
                        answer == Answer::kStopped ||
                        answer == Answer::kBadProgram;  // load() has noted the reason
      if (!fine && subscription->count(answer) > 0) {
        node_.noteError(subscription->topic() + ": refused: " + textOf(answer));
      }
    }
  }
}

void RosCommands::addTo(Diagnostics& diagnostics) {
  Diagnostics::Status status;
  status.name = names_.lab() + ": commands from ROS 2";
  std::int64_t refused = 0;
  for (const auto& subscription : ros_subscriptions_) {
    const dds::Matching matching = subscription->reader().matching();
    if (subscription->reader().received() == 0 && matching.peers == 0 && matching.refused == 0)
      continue;
    std::string text = fmt::format("publishers {}, received {}", matching.peers,
                                   subscription->reader().received());
    for (int i = 0; i < kAnswers; ++i) {
      const auto answer = static_cast<Answer>(i);
      const std::int64_t count = subscription->count(answer);
      if (count == 0) continue;
      text += fmt::format(", {}: {}", textOf(answer), count);
      if (answer != Answer::kTaken && answer != Answer::kClamped) refused += count;
    }
    if (subscription->superseded() > 0)
      text += fmt::format(", replaced by newer: {}", subscription->superseded());
    if (subscription->reader().overrun() > 0)
      text += fmt::format(", lost: {}", subscription->reader().overrun());
    if (matching.refused > 0) {
      text += fmt::format(", publishers refused: {} (ROS side offers another {})", matching.refused,
                          matching.why);
    }
    status.values.emplace_back(subscription->topic() + " " + subscription->typeName(),
                               std::move(text));
  }
  status.values.emplace_back("robots held", std::to_string(arbiter_.held()));
  status.values.emplace_back("made to stand by silence", std::to_string(arbiter_.silences()));
  status.level = refused > 0 ? Diagnostics::kWarn : Diagnostics::kOk;
  status.message = refused > 0 ? fmt::format("{} refused", refused) : "";
  diagnostics.add(std::move(status));
}

}  // namespace lab::gateway
