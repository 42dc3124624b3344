#include "sim_svc/bodies/bus_robots.hpp"

#include <algorithm>
#include <cmath>

#include "common/experiment/program_messages.hpp"
#include "common/math/units.hpp"
#include "common/programs/fixed_of.hpp"
#include "common/programs/program_library.hpp"
#include "sim_svc/bodies/experiment_setup.hpp"

namespace lab::sim {
namespace {

double gainOf(const dynamics::WheelCalibration& wheel) { return wheel.gain_ppm * 1e-6; }

double deadBandOf(const dynamics::WheelCalibration& wheel) {
  return wheel.dead_band / static_cast<double>(dynamics::kMaxDuty);
}

bool isFinite(const motor_calibration_t& motors) {
  return std::isfinite(motors.gain_left) && std::isfinite(motors.gain_right) &&
         std::isfinite(motors.dead_band_left) && std::isfinite(motors.dead_band_right) &&
         std::isfinite(motors.wheel_base);
}

bool contains(const std::vector<std::int32_t>& ids, std::int32_t id) {
  return std::find(ids.begin(), ids.end(), id) != ids.end();
}

}  // namespace

BusRobots::BusRobots(World& world, const std::vector<std::size_t>& bodies, double sensor_period)
    : world_(world), sensor_period_(sensor_period) {
  for (const std::size_t body : bodies) {
    links_[world.id(body)].body = body;
    world.setReversesFromRobots(body, false);
  }
}

std::string BusRobots::handle(const robot_command_t& command) {
  std::string refusal;
  for (const robot_order_t& order : command.orders) {
    std::map<double, OrderSettings> settings;  // by the wheel base stored in the robot
    for (const std::int32_t id : order.robot_ids) {
      const auto entry = links_.find(id);
      if (entry == links_.end()) continue;
      Link& link = entry->second;
      ++link.messages_to;
      const bool known =
          link.command_seq == command.seq && link.command_instance == command.instance;
      if (!known) {
        const double wheel_base = world_.storedWheelBase(link.body);
        const auto [converted, is_new] = settings.try_emplace(wheel_base);
        if (is_new) {
          converted->second =
              settingsFrom(order, {world_.settings().max_wheel_speed, wheel_base}, sensor_period_);
          keepPrograms(converted->second);
        }
        if (!converted->second.refusal.empty()) refusal = converted->second.refusal;
        link.command_seq = command.seq;
        link.command_instance = command.instance;
        execute(link, order, converted->second);
      }
      const auto lease_ms = static_cast<std::uint32_t>(std::max(0, command.lease_ms));
      world_.order(link.body, [lease_ms](dynamics::RobotCore& core, std::uint32_t now_ms) {
        core.renewLease(now_ms, lease_ms);
      });
    }
  }
  return refusal;
}

void BusRobots::keepPrograms(OrderSettings& settings) {
  if (!settings.refusal.empty()) return;
  for (const program_t& program : settings.programs) {
    if (program.id.hash == 0) continue;
    if (world_.addProgram(static_cast<std::uint32_t>(program.id.hash), program.code)) continue;
    settings.refusal = "there were " + std::to_string(ProgramLibrary::kMost) +
                       " different programs since the start of sim_svc, which keeps no more";
  }
}

void BusRobots::execute(Link& link, const robot_order_t& order, const OrderSettings& settings) {
  link.rejected = !settings.refusal.empty();
  if (link.rejected) return;
  dynamics::CoreSettings core_settings = settings.core;
  core_settings.robot_id = static_cast<std::uint16_t>(world_.id(link.body));
  switch (order.mode) {
    case robot_order_t::TABLE:
      link.programs.clear();
      for (const program_t& program : settings.programs) link.programs.push_back(program.id);
      world_.setReversesFromRobots(link.body, order.reverse_on == robot_order_t::REVERSE_ANY);
      world_.order(link.body, [&core_settings](dynamics::RobotCore& core, std::uint32_t now_ms) {
        core.configure(now_ms, core_settings);
        core.runPrograms(now_ms);
      });
      break;
    case robot_order_t::DRIVE: {
      const auto left = static_cast<std::int32_t>(std::lround(order.wheel_left * 1e6));
      const auto right = static_cast<std::int32_t>(std::lround(order.wheel_right * 1e6));
      world_.order(link.body,
                   [&core_settings, left, right](dynamics::RobotCore& core, std::uint32_t now_ms) {
                     core.configure(now_ms, core_settings);
                     core.driveWheels(now_ms, left, right);
                   });
      break;
    }
    default:
      world_.order(link.body,
                   [](dynamics::RobotCore& core, std::uint32_t now_ms) { core.stand(now_ms); });
  }
}

void BusRobots::handle(const robot_stop_t& stop) {
  for (auto& [id, link] : links_) {
    if (!stop.robot_ids.empty() && !contains(stop.robot_ids, id)) continue;
    ++link.messages_to;
    link.stop_seq = stop.seq;
    world_.order(link.body, [&stop](dynamics::RobotCore& core, std::uint32_t now_ms) {
      stop.clear != 0 ? core.clearStop(now_ms) : core.stop(now_ms);
    });
  }
}

void BusRobots::handle(const robot_senses_t& senses, std::int64_t utime) {
  for (const sense_values_t& robot : senses.robots) {
    const auto entry = links_.find(robot.robot_id);
    if (entry == links_.end()) continue;
    Link& link = entry->second;
    ++link.messages_to;
    link.senses_utime = senses.utime;
    link.senses_since_utime = utime;
    world_.order(link.body, [&robot](dynamics::RobotCore& core, std::uint32_t now_ms) {
      core.advanceTo(now_ms);
      for (std::uint8_t i = 0; i < dynamics::kSenses; ++i) {
        core.setSense(i, fixedOf(static_cast<double>(robot.values[i])));
      }
    });
  }
}

std::optional<robot_calibration_t> BusRobots::handle(const robot_calibration_t& calibration) {
  robot_calibration_t held{};
  held.seq = calibration.seq;
  for (const motor_calibration_t& motors : calibration.robots) {
    const auto entry = links_.find(motors.robot_id);
    if (entry == links_.end() || !isFinite(motors)) continue;
    const std::size_t body = entry->second.body;
    const bool only_asks = motors.gain_left == 0;
    if (!only_asks) {
      world_.setCalibration(body, wheelCalibration(motors.gain_left, motors.dead_band_left),
                            wheelCalibration(motors.gain_right, motors.dead_band_right),
                            std::round(std::clamp(motors.wheel_base, 0.01, 0.5) * 1e6) * 1e-6);
    }
    motor_calibration_t stored{};
    stored.robot_id = motors.robot_id;
    stored.gain_left = gainOf(world_.storedLeft(body));
    stored.gain_right = gainOf(world_.storedRight(body));
    stored.dead_band_left = deadBandOf(world_.storedLeft(body));
    stored.dead_band_right = deadBandOf(world_.storedRight(body));
    stored.wheel_base = world_.storedWheelBase(body);
    held.robots.push_back(stored);
  }
  held.num_robots = static_cast<std::int32_t>(held.robots.size());
  if (held.robots.empty()) return std::nullopt;
  return held;
}

void BusRobots::report(std::int64_t origin_utime, std::vector<robot_state_t>& states) {
  for (auto& [id, link] : links_) states.push_back(stateOf(link, origin_utime));
}

robot_state_t BusRobots::stateOf(Link& link, std::int64_t origin_utime) {
  const RobotState state = world_.state(link.body);
  const auto utimeOf = [origin_utime](double world_seconds) {
    return origin_utime + units::microseconds(world_seconds);
  };
  robot_state_t message{};
  message.utime = origin_utime + world_.timeUs();
  message.robot_id = state.id;
  message.origin = robot_state_t::SIM;
  const bool in_table = state.core.slot < link.programs.size();
  if (in_table) {
    message.program = link.programs[state.core.slot];
  } else if ((state.core.flags & dynamics::kDriven) != 0) {
    message.program.name = kDrivenByHost;
  }
  message.phase = static_cast<std::int8_t>(state.core.phase);
  message.band = static_cast<std::int8_t>(in_table ? state.core.slot : -1);
  message.program_epoch = static_cast<std::int32_t>(state.core.program_epoch);
  message.program_start_utime = utimeOf(state.program_start);
  message.wheel_left = state.wheel_left;
  message.wheel_right = state.wheel_right;
  message.program_left = state.program_left;
  message.program_right = state.program_right;
  constexpr double kFullScale = dynamics::kLightCounts - 1;
  message.light_front = static_cast<float>(state.sensors.light_front / kFullScale);
  message.light_back = static_cast<float>(state.sensors.light_back / kFullScale);
  for (std::size_t sensor = 0; sensor < dynamics::kIrSensors; ++sensor) {
    message.ir[sensor] = static_cast<std::int16_t>(state.sensors.ir[sensor]);
  }

  const bool reversing = (state.core.flags & dynamics::kReversing) != 0;
  message.flags = state.core.flags & (dynamics::kReversing | dynamics::kStopped |
                                      dynamics::kLeaseExpired | dynamics::kTumbling);
  if (state.core.saturation_count != link.saturations) {
    message.flags |= robot_state_t::FLAG_SATURATED;
  }
  if (state.contact_robot || state.robot_contacts != link.robot_contacts) {
    message.flags |= robot_state_t::FLAG_CONTACT_ROBOT;
  }
  if (state.contact_wall || state.wall_contacts != link.wall_contacts) {
    message.flags |= robot_state_t::FLAG_CONTACT_WALL;
  }
  if (link.rejected) message.flags |= robot_state_t::FLAG_REJECTED;
  link.saturations = state.core.saturation_count;
  link.robot_contacts = state.robot_contacts;
  link.wall_contacts = state.wall_contacts;

  message.command_seq = link.command_seq;
  message.command_instance = link.command_instance;
  message.stop_seq = link.stop_seq;
  message.reversal_count = static_cast<std::int32_t>(state.core.reversal_count);
  if (message.reversal_count > 0) {
    message.reversal_start_utime = utimeOf(state.reversal_start);
    message.reversal_end_utime = reversing ? 0 : utimeOf(state.reversal_end);
  }
  message.tumble_count = static_cast<std::int32_t>(state.core.tumble_count);
  // In seconds of the host, as in robot_bridge, not of the robot's clock.
  message.run_time = state.run_time / world_.clock(link.body).rate();
  message.senses_utime = link.senses_utime;
  message.senses_since_utime = link.senses_since_utime;
  message.battery = static_cast<float>(state.battery);
  message.link_sent = link.messages_to;
  message.link_received = ++link.messages_from;
  return message;
}

}  // namespace lab::sim
