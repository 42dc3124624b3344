#include "runner/senses/sense_sender.hpp"

#include <algorithm>
#include <cmath>
#include <lab/robot_senses_t.hpp>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/math/units.hpp"

namespace lab::runner {
namespace {

bool needsLight(const Senses& senses) {
  return std::ranges::any_of(senses.values, [](const SenseSpec& sense) {
    return sense.kind == SenseKind::kGradient || sense.kind == SenseKind::kGradientBearing;
  });
}

}  // namespace

SenseSender::SenseSender(const ServiceContext& context)
    : node_(context.node),
      loop_(context.loop),
      senses_(context.experiment.senses),
      images_(loadImages(context.experiment, context.directory)) {
  if (senses_.values.empty()) return;
  node_.subscribe<tracked_frame_t>(channels::kTrackedFrame,
                                   [this](const tracked_frame_t& frame) { take(frame); });
  if (!needsLight(senses_)) return;
  node_.subscribe<light_status_t>(channels::kLightStatus,
                                  [this](const light_status_t& status) { take(status); });
}

void SenseSender::take(const light_status_t& status) {
  const light::Field field = toField(status, images_.store);
  if (light::validate(field.layers) || light::validate(field.previous)) return;
  light_.emplace(field);
}

void SenseSender::take(const tracked_frame_t& frame) {
  if (frame.utime < next_utime_) return;
  const std::int64_t period = units::microseconds(1 / senses_.rate);
  // Keeps the rate when frames come at other times, and begins again after a pause.
  next_utime_ = std::max(next_utime_ + period, frame.utime + period / 2);

  std::vector<SensedPose> poses;
  for (const tracked_pose_t& pose : frame.robots) {
    if (pose.robot_id < 0) continue;
    poses.push_back({pose.robot_id, pose.x, pose.y, pose.theta});
  }
  LightAt light;
  if (light_) light = [this](double x, double y) { return light_->evaluate(x, y); };
  const std::vector<SenseValues> values = virtualSenses(senses_.values, poses, light);

  robot_senses_t message{};
  message.utime = frame.utime;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    sense_values_t robot{};
    robot.robot_id = poses[i].id;
    std::ranges::transform(values[i], robot.values,
                           [](double value) { return static_cast<float>(value); });
    message.robots.push_back(robot);
  }
  message.num_robots = static_cast<std::int32_t>(message.robots.size());
  const std::int64_t send_utime = frame.utime + units::microseconds(senses_.delay);
  if (send_utime <= loop_.now()) {
    node_.publish(channels::kRobotSenses, message);
  } else {
    loop_.at(send_utime,
             [this, message]() mutable { node_.publish(channels::kRobotSenses, message); });
  }
}

}  // namespace lab::runner
