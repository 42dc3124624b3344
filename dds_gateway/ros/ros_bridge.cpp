#include "dds_gateway/ros/ros_bridge.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/experiment/program_messages.hpp"
#include "common/math/units.hpp"
#include "dds_gateway/dds/error.hpp"
#include "dds_gateway/gateway_domain.hpp"

namespace lab::gateway {
namespace fs = std::filesystem;
namespace {

constexpr std::int64_t kFresh_us = 1'000'000;  // older wheel speeds and poses are not used
constexpr const char* kTf = "/tf";
constexpr const char* kDiagnostics = "/diagnostics";
constexpr const char* kClock = "/clock";

TopicMapping mappingOf(const Gateway& gateway, const fs::path& directory) {
  return gateway.mapping.empty() ? TopicMapping()
                                 : readTopicMappingFile(directory / gateway.mapping);
}

bool sameLight(const light::Field& a, const light::Field& b) {
  return a.mix == b.mix && a.layers == b.layers && (a.mix >= 1 || a.previous == b.previous);
}

const char* originName(std::int8_t origin) {
  switch (origin) {
    case robot_state_t::REAL:
      return "real";
    case robot_state_t::SIM:
      return "sim";
    case robot_state_t::REPLAY:
      return "replay";
    default:
      return "unknown";
  }
}

}  // namespace

RosBridge::RosBridge(const ServiceContext& context)
    : node_(context.node),
      loop_(context.loop),
      experiment_(context.experiment),
      names_(experiment_.gateway.name),
      mapping_(mappingOf(experiment_.gateway, context.directory)),
      domain_(joinDomain(experiment_.gateway, context.directory)),
      publishers_(domain_, mapping_),
      foreign_(domain_),
      images_(loadImages(experiment_, context.directory)),
      arena_(names_.arenaFrame()),
      grid_(experiment_.arena_width, experiment_.arena_height, arena_),
      analysis_(arena_),
      status_(names_, publishers_, foreign_) {
  try {
    openTopics();
    if (experiment_.gateway.commands) {
      commands_ = std::make_unique<RosCommands>(context, domain_, mapping_, names_);
    }
  } catch (const std::runtime_error& error) {
    throw ExperimentError({error.what()});
  }
  subscribe();
  loop_.every(units::kSecond_us, loop_.now(), [this] { everySecond(); });
}

void RosBridge::openTopics() {
  tf_ = publishers_.open<ros::TFMessage>(kTf, ros::tfQos(ros::rosType<ros::TFMessage>()));
  diagnostics_ = publishers_.open<ros::DiagnosticArray>(kDiagnostics);
  poses_ = publishers_.openLatched<ros::PoseArray>(names_.topic("poses"));
  light_field_ = publishers_.openLatched<ros::OccupancyGrid>(names_.topic("light_field"));
  robot_list_ = publishers_.openLatched<ros::String>(names_.topic("robots"));
  if (!publishers_.trouble().empty()) throw std::runtime_error(publishers_.trouble());
  // Finds rules that make an invalid name now, not when the robot appears.
  std::vector<std::string> later{"pose", "odom", "light"};
  for (const auto& [name, program] : experiment_.programs) {
    analyzed_.insert(namePart(name));
    later.push_back("analysis/" + namePart(name));
    static_cast<void>(mapping_.route(names_.topic(later.back())));
  }
  for (const RobotSpec& spec : experiment_.robots) {
    for (const std::string& what : later) {
      static_cast<void>(mapping_.route(names_.topic(spec.id, what)));
    }
  }
  static_cast<void>(mapping_.route(kClock));
}

void RosBridge::subscribe() {
  node_.subscribe<tracked_frame_t>(channels::kTrackedFrame,
                                   [this](const tracked_frame_t& frame) { take(frame); });
  node_.subscribe<robot_status_t>(channels::kRobotStatus,
                                  [this](const robot_status_t& status) { take(status); });
  node_.subscribe<light_status_t>(channels::kLightStatus,
                                  [this](const light_status_t& status) { take(status); });
  node_.subscribe<analysis_t>(channels::kAnalysis,
                              [this](const analysis_t& analysis) { take(analysis); });
  node_.subscribe<clock_t>(channels::kClock, [this](const clock_t& clock) { take(clock); });
  node_.subscribe<service_status_t>(
      channels::kServiceStatus,
      [this](const service_status_t& status) { status_.take(status, loop_.now()); });
}

RosBridge::Robot* RosBridge::robot(std::int32_t id) {
  const auto known = robots_.find(id);
  if (known != robots_.end()) {
    known->second.heard_utime = loop_.now();
    return &known->second;
  }
  if (id < 0 || robots_.size() >= kMostRobots) {
    ++refused_robots_;
    return nullptr;
  }
  Robot robot{.messages = RobotMessages(arena_, names_.robotFrame(id)),
              .pose = publishers_.openLatched<ros::PoseStamped>(names_.topic(id, "pose")),
              .odometry = publishers_.open<ros::Odometry>(names_.topic(id, "odom")),
              .light = publishers_.open<ros::Illuminance>(names_.topic(id, "light")),
              .analysis = {},
              .tracked = {},
              .motion = {},
              .program = {}};
  robot.heard_utime = loop_.now();
  return &robots_.emplace(id, std::move(robot)).first->second;
}

void RosBridge::take(const tracked_frame_t& frame) {
  transforms_.clear();
  const bool tf = tf_ && tf_->admit(frame.utime);
  for (const tracked_pose_t& pose : frame.robots) {
    Robot* known = robot(pose.robot_id);
    if (known == nullptr) continue;
    known->tracked = pose;
    known->tracked_utime = frame.utime;
    if (tf) transforms_.push_back(known->messages.transform(frame.utime, pose));
    if (known->pose && known->pose->admit(frame.utime)) {
      const ros::PoseStamped message = known->messages.pose(frame.utime, pose);
      known->pose->write(&message);
    }
    if (known->odometry && known->odometry->admit(frame.utime)) {
      const bool fresh = std::abs(frame.utime - known->motion_utime) < kFresh_us;
      const ros::Odometry message =
          known->messages.odometry(frame.utime, pose, fresh ? &known->motion : nullptr);
      known->odometry->write(&message);
    }
  }
  if (tf) {
    ros::TFMessage message{};
    message.transforms._length = message.transforms._maximum =
        static_cast<std::uint32_t>(transforms_.size());
    message.transforms._buffer = transforms_.data();
    tf_->write(&message);
  }
  sendPoses(frame.utime);
}

/// The poses of all trackers together: the frames of one tracker lack the robots of another.
void RosBridge::sendPoses(std::int64_t utime) {
  if (!poses_ || !poses_->admit(utime)) return;
  pose_array_.clear();
  for (const auto& [id, robot] : robots_) {
    const bool here = robot.tracked && std::abs(utime - robot.tracked_utime) < kFresh_us;
    if (here) pose_array_.push_back(toPose(*robot.tracked));
  }
  ros::PoseArray message{};
  message.header = {stampOf(utime), cText(arena_)};
  message.poses._length = message.poses._maximum = static_cast<std::uint32_t>(pose_array_.size());
  message.poses._buffer = pose_array_.data();
  poses_->write(&message);
}

void RosBridge::take(const robot_status_t& status) {
  for (const robot_state_t& state : status.robots) {
    Robot* known = robot(state.robot_id);
    if (known == nullptr) continue;
    known->motion = motionOf(state.wheel_left, state.wheel_right, experiment_.hardware.diameter);
    known->motion_utime = state.utime;
    known->origin = state.origin;
    known->program = programName(experiment_, state.program);
    if (known->light && known->light->admit(state.utime)) {
      const ros::Illuminance message = known->messages.light(state, experiment_.light_table.sensor);
      known->light->write(&message);
    }
  }
}

void RosBridge::take(const light_status_t& status) {
  if (!light_field_) return;
  light::Field field = toField(status, images_.store);
  const bool changed = !shown_ || !sameLight(*shown_, field);
  // If this status is thinned out, the next one replaces it: LIGHT_STATUS comes at 10 Hz even
  // while nothing changes.
  if (!changed || !light_field_->admit(status.utime)) return;
  if (light::validate(field.layers) || light::validate(field.previous)) {
    node_.noteError("LIGHT_STATUS of " + status.sender + " cannot be painted: ignored");
    return;
  }
  const ros::OccupancyGrid& grid =
      grid_.paint(light::CompiledField(field), status.utime, status.first_shown_utime);
  light_field_->write(&grid);
  shown_ = std::move(field);
}

/// Whether a program gets topics for its ANALYSIS: those of the experiment, and others up to
/// kMostAnalyzed. Each takes a DDS writer for each robot.
bool RosBridge::mayAnalyze(const std::string& part) {
  if (analyzed_.contains(part)) return true;
  if (analyzed_.size() < kMostAnalyzed && part.size() <= kLongestTopicName) {
    analyzed_.insert(part);
    return true;
  }
  if (!std::exchange(analysis_limit_noted_, true)) {
    node_.noteError(
        fmt::format("ANALYSIS of more than {} programs, or of a name longer than {} "
                    "characters: further ones are not published for ROS 2",
                    kMostAnalyzed, kLongestTopicName));
  }
  return false;
}

void RosBridge::take(const analysis_t& analysis) {
  const std::string part = namePart(analysis.program.name);
  if (!mayAnalyze(part)) return;
  RosPublishers::Handle* publisher = nullptr;
  std::string topic;
  if (analysis.robot_id == analysis_t::POOL) {
    publisher = &pool_analysis_.try_emplace(part).first->second;
    topic = names_.topic("analysis/" + part);
  } else if (Robot* known = robot(analysis.robot_id)) {
    publisher = &known->analysis.try_emplace(part).first->second;
    topic = names_.topic(analysis.robot_id, "analysis/" + part);
  }
  if (publisher == nullptr) return;
  if (!*publisher) *publisher = publishers_.openLatched<ros::Analysis>(topic);
  if (!*publisher || !(*publisher)->admit(analysis.utime)) return;
  const Program* program = findProgram(experiment_, analysis.program);
  (*publisher)->write(&analysis_.make(analysis, program != nullptr ? program->text : ""));
}

/// Opens /clock only if the lab's time is not the wall clock: use_sim_time needs it then.
void RosBridge::take(const clock_t& clock) {
  if (!clock_) clock_ = publishers_.open<ros::Clock>(kClock);
  if (!clock_ || !clock_->admit(clock.utime)) return;
  const ros::Clock message{stampOf(clock.utime)};
  clock_->write(&message);
}

void RosBridge::everySecond() {
  forgetRobots();
  sendRobots();
  if (commands_) commands_->everySecond();
  std::multimap<std::string, std::string> types;
  if (commands_) {
    for (const auto& subscription : commands_->rosSubscriptions()) {
      types.emplace(ros::topicName(subscription->topic()), subscription->typeName());
    }
  }
  for (const RosPublishers::Handle& publisher : publishers_.all()) {
    types.emplace(ros::topicName(publisher->topic()), publisher->typeName());
  }
  foreign_.update(types);
  if (foreign_.count() > 0) {
    node_.noteError("a topic of the lab is used with another type: " + foreign_.last());
  }
  if (!publishers_.trouble().empty()) node_.noteError(publishers_.trouble());
  const std::string warnings = dds::takeWarnings();
  if (!warnings.empty()) status_.setWarnings(warnings);
  sendDiagnostics();
  // This error is noted last, and only for new payloads: the others are noted again each second.
  const std::int64_t malformed = dds::malformedReceived();
  if (malformed > malformed_) {
    node_.noteError("DDS brought payloads that are not messages of their topic, dropped: " +
                    warnings.substr(0, warnings.find('\n')));
  }
  malformed_ = malformed;
}

void RosBridge::sendDiagnostics() {
  if (!diagnostics_ || !diagnostics_->admit(loop_.now())) return;
  Diagnostics diagnostics;
  diagnostics_->write(&status_.make(diagnostics, loop_.now(), refused_robots_, commands_.get()));
}

void RosBridge::forgetRobots() {
  std::erase_if(robots_, [this](const auto& entry) {
    return loop_.now() - entry.second.heard_utime > kForget_us;
  });
}

void RosBridge::sendRobots() {
  if (!robot_list_) return;
  nlohmann::json list = nlohmann::json::array();
  for (const auto& [id, robot] : robots_) {
    list.push_back({{"id", id},
                    {"name", robotName(id)},
                    {"namespace", "/" + names_.lab() + "/" + robotName(id)},
                    {"frame", names_.robotFrame(id)},
                    {"origin", originName(robot.origin)},
                    {"program", robot.program}});
  }
  const auto replace = nlohmann::json::error_handler_t::replace;
  std::string text = list.dump(-1, ' ', false, replace);
  if (text == robot_text_ || !robot_list_->admit(loop_.now())) return;
  robot_text_ = std::move(text);
  const ros::String message{cText(robot_text_)};
  robot_list_->write(&message);
}

}  // namespace lab::gateway
