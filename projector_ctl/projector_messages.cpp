#include "projector_ctl/projector_messages.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "common/experiment/light_messages.hpp"
#include "common/experiment/program_messages.hpp"
#include "common/text/utf8.hpp"

namespace lab::projector {
namespace {

// LIGHT_STATUS repeats the label, and receivers refuse a large one. Labels of files have 60 bytes.
constexpr std::size_t kLongestLabel = 200;

}  // namespace

SceneContext sceneContextOf(const Experiment& experiment, light::ImageStore images) {
  SceneContext scene_context;
  scene_context.arena_width = experiment.arena_width;
  scene_context.arena_height = experiment.arena_height;
  for (const RobotSpec& robot : experiment.robots) scene_context.robots.push_back(robot.id);
  for (const auto& [name, program] : experiment.programs) scene_context.programs.push_back(name);
  // Robots that stand report this program, and a gate may select them.
  scene_context.programs.push_back(kStanding);
  scene_context.images = std::move(images);
  return scene_context;
}

LightCommand toCommand(const light_command_t& message, const Experiment& experiment,
                       const light::ImageStore& images) {
  LightCommand command;
  command.sender = message.sender;
  command.instance = message.instance;
  command.seq = message.seq;
  command.priority = message.priority;
  command.from_utime = message.from_utime != 0 ? message.from_utime : message.utime;
  command.ramp = message.ramp;
  command.hold_until_utime = message.hold_until_utime;
  command.release = message.release != 0;
  command.label = utf8Prefix(message.label, kLongestLabel);
  if (message.layers.size() <= light::kMostLayers) {
    command.layers = toDrivenLayers(message, images);
  } else {
    // One layer too many, so the command is refused; converting all would be wasted.
    command.layers.resize(light::kMostLayers + 1);
  }
  for (light::DrivenLayer& layer : command.layers) {
    const auto program = experiment.programs.find(layer.drive.gate_program);
    if (program != experiment.programs.end()) {
      layer.drive.gate_program = programName(experiment, toId(program->second));
    }
  }
  return command;
}

ObservedFrame toObservedFrame(const tracked_frame_t& message) {
  ObservedFrame frame{message.instance, message.frame, message.utime, {}};
  for (const tracked_pose_t& pose : message.robots) {
    if (pose.robot_id < 0) continue;
    frame.robots.push_back({pose.robot_id, pose.x, pose.y, pose.theta,
                            std::max(pose.covariance[0], pose.covariance[3]), pose.covariance[5],
                            static_cast<double>(pose.confidence)});
  }
  return frame;
}

ShownRecord toShownRecord(const light_status_t& message) {
  ShownRecord record;
  record.projector = message.instance;
  record.utime = message.utime;
  record.latency = message.latency;
  record.commander = message.commander;
  record.command_instance = message.command_instance;
  record.command_seq = message.command_seq;
  record.tracker_instance = message.tracker_instance;
  record.tracked_frames = message.tracked_frames;
  record.layers = toLayers(message.layers);
  return record;
}

}  // namespace lab::projector
