// What the simulated robots say, with the robots' own times turned into the world's.
#include "sim_svc/world.hpp"

namespace lab::sim {
namespace {

constexpr double kMicro = 1e-6;
constexpr double kBatteryFall = 0.15 / 3600;  // V/s

}  // namespace

dynamics::Pose World::pose(std::size_t i) const {
  return {centres_[i].x, centres_[i].y, bodies_[i].theta};
}

Motion World::motion(std::size_t i) const {
  const Body& body = bodies_[i];
  const bool held = body.robot_contact.last_step == steps_ || body.wall_contact.last_step == steps_;
  return {held ? 0 : body.speed, body.turn};
}

RobotState World::state(std::size_t i) const {
  const Electronics& robot = electronics_[i];
  const auto world_time = [&](std::uint32_t ms) {
    return robot.clock.worldTime(unwrapMs(ms, robot.local_ms));
  };
  RobotState state;
  state.id = robot.id;
  state.external = robot.external;
  state.pose = pose(i);
  state.wheel_left = robot.wheels.left * kMicro;
  state.wheel_right = robot.wheels.right * kMicro;
  state.core = robot.core.report();
  state.program_left = state.core.held.left * kMicro;
  state.program_right = state.core.held.right * kMicro;
  state.program_start = state.core.program_epoch == 0 ? 0 : world_time(state.core.program_start_ms);
  if (state.core.reversal_count > 0) {
    state.reversal_start = world_time(state.core.reversal_start_ms);
    state.reversal_end = world_time(state.core.reversal_end_ms);
  }
  state.run_time =
      robot.core.runTimeMs(static_cast<std::uint32_t>(robot.clock.localMs(time()))) * 1e-3;
  state.sensors = robot.external ? measure(i) : robot.sensors;
  state.sampled_at = robot.last_scan_ms < 0 ? time() : robot.clock.worldTime(robot.last_scan_ms);
  state.battery = robot.battery_full - kBatteryFall * time();
  state.contact_robot = bodies_[i].robot_contact.last_step == steps_;
  state.contact_wall = bodies_[i].wall_contact.last_step == steps_;
  state.robot_contacts = bodies_[i].robot_contact.begun;
  state.wall_contacts = bodies_[i].wall_contact.begun;
  return state;
}

}  // namespace lab::sim
