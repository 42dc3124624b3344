#include "dds_gateway/ros_recording.hpp"

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "common/experiment/light_messages.hpp"
#include "common/experiment/program_messages.hpp"
#include "dds_gateway/ros/ros_cdr.hpp"
#include "dds_gateway/ros/ros_definitions.hpp"
#include "dds_gateway/ros/ros_names.hpp"
#include "dds_gateway/ros/to_ros.hpp"

namespace lab::gateway {
namespace {

bool sameLight(const light::Field& a, const light::Field& b) {
  return a.mix == b.mix && a.layers == b.layers && (a.mix >= 1 || a.previous == b.previous);
}

}  // namespace

std::string rosDefinition(const std::string& name) { return ros::msgDefinition(name); }

class RosRecording::Implementation {
 public:
  Implementation(const Experiment& experiment, const std::filesystem::path& directory,
                 const Options& options, Sink sink)
      : experiment_(experiment),
        options_(options),
        sink_(std::move(sink)),
        names_(experiment.gateway.name),
        images_(loadImages(experiment, directory)),
        arena_(names_.arenaFrame()),
        grid_(experiment.arena_width, experiment.arena_height, arena_),
        analysis_(arena_),
        poses_topic_(names_.topic("poses")),
        light_topic_(names_.topic("light_field")) {}

  void take(const tracked_frame_t& frame) {
    std::vector<ros::TransformStamped> transforms;
    std::vector<ros::Pose> poses;
    for (const tracked_pose_t& pose : frame.robots) {
      Robot& known = robot(pose.robot_id);
      transforms.push_back(known.messages.transform(frame.utime, pose));
      poses.push_back(toPose(pose));
      if (options_.each_robot)
        send(known.pose, frame.utime, known.messages.pose(frame.utime, pose));
    }
    ros::TFMessage tf{};
    fill(tf.transforms, transforms);
    send("/tf", frame.utime, tf);
    ros::PoseArray array{};
    array.header = {stampOf(frame.utime), cText(arena_)};
    fill(array.poses, poses);
    send(poses_topic_, frame.utime, array);
  }

  void take(const robot_status_t& status) {
    if (!options_.each_robot) return;
    for (const robot_state_t& state : status.robots) {
      Robot& known = robot(state.robot_id);
      send(known.light, state.utime, known.messages.light(state, experiment_.light_table.sensor));
    }
  }

  void take(const light_status_t& status) {
    light::Field field = toField(status, images_.store);
    if (light::validate(field.layers) || light::validate(field.previous)) return;
    if (shown_ && sameLight(*shown_, field)) return;
    const std::int64_t kPeriod_us = 200'000;  // as the gateway publishes it: at most 5 Hz
    if (shown_ && status.utime < shown_utime_ + kPeriod_us) return;
    shown_utime_ = status.utime;
    send(light_topic_, status.utime,
         grid_.paint(light::CompiledField(field), status.utime, status.first_shown_utime));
    shown_ = std::move(field);
  }

  void take(const analysis_t& analysis) {
    const std::string part = "analysis/" + namePart(analysis.program.name);
    const bool pool = analysis.robot_id == analysis_t::POOL;
    if (!pool && !options_.each_robot) return;
    const Program* program = findProgram(experiment_, analysis.program);
    send(pool ? names_.topic(part) : names_.topic(analysis.robot_id, part), analysis.utime,
         analysis_.make(analysis, program != nullptr ? program->text : ""));
  }

 private:
  struct Robot {
    RobotMessages messages;
    std::string pose;
    std::string light;
  };

  Robot& robot(std::int32_t id) {
    const auto known = robots_.find(id);
    if (known != robots_.end()) return known->second;
    return robots_
        .emplace(id, Robot{RobotMessages(arena_, names_.robotFrame(id)), names_.topic(id, "pose"),
                           names_.topic(id, "light")})
        .first->second;
  }

  template <class Sequence, class Element>
  static void fill(Sequence& sequence, std::vector<Element>& elements) {
    sequence._length = sequence._maximum = static_cast<std::uint32_t>(elements.size());
    sequence._buffer = elements.data();
  }

  template <class RosMessage>
  void send(const std::string& topic, std::int64_t utime, const RosMessage& message) {
    sink_({topic, ros::rosType<RosMessage>().name, utime, cdr_.encode(message)});
  }

  const Experiment& experiment_;
  Options options_;
  Sink sink_;
  RosNames names_;
  ExperimentImages images_;
  std::string arena_;
  LightGrid grid_;
  AnalysisMessage analysis_;
  std::string poses_topic_;
  std::string light_topic_;
  std::map<std::int32_t, Robot> robots_;
  std::optional<light::Field> shown_;
  std::int64_t shown_utime_ = 0;
  ros::RosCdr cdr_;
};

RosRecording::RosRecording(const Experiment& experiment, const std::filesystem::path& directory,
                           const Options& options, Sink sink)
    : implementation_(
          std::make_unique<Implementation>(experiment, directory, options, std::move(sink))) {}
RosRecording::~RosRecording() = default;
void RosRecording::take(const tracked_frame_t& frame) { implementation_->take(frame); }
void RosRecording::take(const robot_status_t& status) { implementation_->take(status); }
void RosRecording::take(const light_status_t& status) { implementation_->take(status); }
void RosRecording::take(const analysis_t& analysis) { implementation_->take(analysis); }

}  // namespace lab::gateway
