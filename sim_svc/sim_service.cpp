#include "sim_svc/sim_service.hpp"

#include <algorithm>
#include <cmath>
#include <lab/robot_status_t.hpp>
#include <lab/sim_truth_t.hpp>

#include "common/channels.hpp"
#include "common/units.hpp"
#include "light/layer.hpp"

namespace lab::sim {
namespace {

constexpr double kTruthRate = 10;                  // [1/s]
constexpr std::int64_t kOldestFrame_us = 200'000;  // a live camera does not queue more than this

WorldSettings worldSettings(const Experiment& experiment) {
  const RobotHardware& hardware = experiment.hardware;
  WorldSettings settings;
  settings.arena = {experiment.arena_width, experiment.arena_height};
  settings.seed = experiment.seed;
  settings.radius = hardware.diameter / 2;
  settings.wheel_base = hardware.diameter;
  settings.max_wheel_speed = hardware.max_wheel_speed;
  settings.pwm_steps = hardware.pwm_steps;
  settings.wheel_gain_error = hardware.wheel_gain_error;
  settings.speed_noise = hardware.speed_noise;
  settings.turn_noise = hardware.turn_noise;
  settings.clock_error = hardware.clock_error;
  settings.ir_range = hardware.ir_range;
  return settings;
}

std::vector<RobotSetup> simulatedRobots(const Experiment& experiment) {
  std::vector<RobotSetup> robots;
  for (const RobotSpec& robot : experiment.robots) {
    if (robot.body != Body::kSim) continue;
    RobotSetup setup;
    setup.id = robot.id;
    if (robot.start)
      setup.pose = dynamics::Pose{robot.start->x, robot.start->y, robot.start->theta};
    robots.push_back(setup);
  }
  return robots;
}

/// The `number`-th sample of something with this rate: no error adds up.
std::int64_t sampleUtime(std::int64_t start_utime, std::int64_t number, double rate) {
  return start_utime +
         static_cast<std::int64_t>(std::llround(static_cast<double>(number) * 1e6 / rate));
}

std::int64_t period_us(double rate) { return std::max<std::int64_t>(1, std::llround(1e6 / rate)); }

}  // namespace

SimService::SimService(const ServiceContext& context)
    : node_(context.node),
      loop_(context.loop),
      experiment_(context.experiment),
      images_(loadImages(context.experiment, context.directory)),
      world_(worldSettings(context.experiment), simulatedRobots(context.experiment)),
      tracker_(context.experiment.camera, context.experiment.seed),
      links_(world_.size()),
      start_utime_(context.loop.now()) {
  // The robots were switched on a little earlier, each at an instant of its own.
  const std::int64_t booted_us = units::microseconds(world_.settings().boot_spread);
  origin_utime_ = start_utime_ - booted_us;
  world_.setLight(&light_);
  world_.advanceTo(booted_us);
  for (std::size_t i = 0; i < world_.size(); ++i) {
    index_[world_.state(i).id] = i;
    world_.setRobotsSeen(i, false);
  }

  node_.subscribe<robot_command_t>(channels::kRobotCommand,
                                   [this](const robot_command_t& command) { take(command); });
  node_.subscribe<robot_stop_t>(channels::kRobotStop,
                                [this](const robot_stop_t& stop) { take(stop); });
  node_.subscribe<light_status_t>(channels::kLightStatus, [this](const light_status_t& status) {
    light::Field field = toField(status, images_.store);
    if (light::validate(field.layers) || light::validate(field.previous)) {
      node_.noteError("LIGHT_STATUS of " + status.sender + " cannot be painted: ignored");
      return;
    }
    follow(loop_.now());
    light_.show(light::CompiledField(field));
  });
  loop_.every(period_us(experiment_.camera.fps), start_utime_, [this] { sampleFrames(); });
  loop_.every(period_us(experiment_.hardware.status_rate), start_utime_,
              [this] { sampleRobots(); });
  loop_.every(period_us(kTruthRate), start_utime_, [this] { sampleTruth(); });
  loop_.soon([this] { node_.ready(); });
}

std::int64_t SimService::utimeOf(double world_seconds) const {
  return origin_utime_ + units::microseconds(world_seconds);
}

void SimService::follow(std::int64_t utime) {
  if (utime - origin_utime_ > world_.timeUs()) world_.advanceTo(utime - origin_utime_);
}

void SimService::sampleFrames() {
  const std::int64_t now = loop_.now();
  const double fps = experiment_.camera.fps;
  for (std::int64_t exposure = sampleUtime(start_utime_, frame_number_, fps); exposure <= now;
       exposure = sampleUtime(start_utime_, ++frame_number_, fps)) {
    const bool seen = tracker_.begin(exposure);
    if (!loop_.isVirtual() && now - exposure > kOldestFrame_us) {
      // The machine stalled. A burst of old frames would drown the listeners.
      node_.noteError("stalled: camera frames from number " +
                      std::to_string(tracker_.frame().frame) + " on were skipped");
      continue;
    }
    follow(exposure);
    if (!seen) continue;
    for (std::size_t i = 0; i < world_.size(); ++i)
      tracker_.see(world_.state(i).id, world_.pose(i));
    loop_.at(exposure + units::microseconds(experiment_.camera.delay),
             [this, frame = tracker_.frame()]() mutable {
               node_.publish(channels::kTrackedFrame, frame);
             });
  }
}

void SimService::sampleRobots() {
  const std::int64_t now = loop_.now();
  const double rate = experiment_.hardware.status_rate;
  std::int64_t due = sampleUtime(start_utime_, status_number_, rate);
  if (due > now) return;
  // What a late timer missed is missed: the next report says all that this one would have.
  while (sampleUtime(start_utime_, status_number_ + 1, rate) <= now) {
    due = sampleUtime(start_utime_, ++status_number_, rate);
  }
  ++status_number_;
  follow(due);
  robot_status_t status{};
  status.utime = origin_utime_ + world_.timeUs();
  status.robots.reserve(world_.size());
  for (std::size_t i = 0; i < world_.size(); ++i) status.robots.push_back(stateOf(i));
  status.num_robots = static_cast<std::int32_t>(status.robots.size());
  node_.publish(channels::kRobotStatus, status);
}

robot_state_t SimService::stateOf(std::size_t i) {
  const RobotState state = world_.state(i);
  Link& link = links_[i];
  robot_state_t message{};
  message.utime = origin_utime_ + world_.timeUs();
  message.robot_id = state.id;
  message.origin = robot_state_t::SIM;
  const bool in_table = state.core.slot < link.programs.size();
  if (in_table) {
    message.program = link.programs[state.core.slot];
  } else if (state.core.kind == dynamics::kWheels) {
    message.program = link.driven;
  }
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
  // As the bridge of a real robot would: in the host's seconds, not in those of the robot's clock.
  message.run_time = state.run_time / world_.clock(i).rate();
  message.battery = static_cast<float>(state.battery);
  message.link_sent = link.messages_to;
  message.link_received = ++link.messages_from;
  return message;
}

void SimService::sampleTruth() {
  const std::int64_t now = loop_.now();
  if (sampleUtime(start_utime_, truth_number_, kTruthRate) > now) return;
  truth_number_ = static_cast<std::int64_t>(units::seconds(now - start_utime_) * kTruthRate) + 1;
  follow(now);
  sim_truth_t truth{};
  truth.utime = origin_utime_ + world_.timeUs();
  truth.collisions = world_.collisions();
  for (std::size_t i = 0; i < world_.size(); ++i) {
    const RobotState state = world_.state(i);
    true_pose_t pose{};
    pose.robot_id = state.id;
    pose.x = state.pose.x;
    pose.y = state.pose.y;
    pose.theta = state.pose.theta;
    pose.program = static_cast<std::int8_t>(state.core.kind);
    pose.contact_robot = state.contact_robot ? 1 : 0;
    pose.contact_wall = state.contact_wall ? 1 : 0;
    truth.robots.push_back(pose);
  }
  truth.num_robots = static_cast<std::int32_t>(truth.robots.size());
  node_.publish(channels::kSimTruth, truth);
}

void SimService::take(const robot_command_t& command) {
  follow(loop_.now());
  for (const robot_order_t& order : command.orders) {
    OrderSettings settings;
    bool converted = false;
    for (const std::int32_t id : order.robot_ids) {
      const auto entry = index_.find(id);
      if (entry == index_.end()) continue;
      Link& link = links_[entry->second];
      ++link.messages_to;
      const bool known =
          link.command_seq == command.seq && link.command_instance == command.instance;
      if (!known) {
        if (!converted) {
          const WorldSettings& world = world_.settings();
          settings = settingsFrom(order, {world.max_wheel_speed, world.wheel_base},
                                  experiment_.hardware.sensor_period);
          if (!settings.refusal.empty()) {
            node_.noteError("ROBOT_COMMAND of " + command.sender + ": " + settings.refusal);
          }
        }
        converted = true;
        link.command_seq = command.seq;
        link.command_instance = command.instance;
        obey(entry->second, order, settings);
      }
      const auto lease_ms = static_cast<std::uint32_t>(std::max(0, command.lease_ms));
      world_.order(entry->second, [lease_ms](dynamics::RobotCore& core, std::uint32_t now_ms) {
        core.renewLease(now_ms, lease_ms);
      });
    }
  }
}

void SimService::obey(std::size_t i, const robot_order_t& order, const OrderSettings& settings) {
  Link& link = links_[i];
  link.rejected = !settings.refusal.empty();
  if (link.rejected) return;
  switch (order.mode) {
    case robot_order_t::TABLE:
      link.programs = settings.programs;
      world_.setRobotsSeen(i, order.reverse_on == robot_order_t::REVERSE_ANY);
      world_.order(i, [&settings](dynamics::RobotCore& core, std::uint32_t now_ms) {
        core.configure(now_ms, settings.core);
        core.runPrograms(now_ms);
      });
      break;
    case robot_order_t::DRIVE: {
      link.driven = {};
      link.driven.kind = program_t::WHEELS;
      link.driven.wheel_left = order.wheel_left;
      link.driven.wheel_right = order.wheel_right;
      const auto left = static_cast<std::int32_t>(std::lround(order.wheel_left * 1e6));
      const auto right = static_cast<std::int32_t>(std::lround(order.wheel_right * 1e6));
      world_.order(i, [&settings, left, right](dynamics::RobotCore& core, std::uint32_t now_ms) {
        core.configure(now_ms, settings.core);
        core.driveWheels(now_ms, left, right);
      });
      break;
    }
    default:
      world_.order(i, [](dynamics::RobotCore& core, std::uint32_t now_ms) { core.stand(now_ms); });
  }
}

void SimService::take(const robot_stop_t& stop) {
  follow(loop_.now());
  const bool everyone = stop.robot_ids.empty();
  for (const auto& [id, i] : index_) {
    const bool meant = everyone || std::find(stop.robot_ids.begin(), stop.robot_ids.end(), id) !=
                                       stop.robot_ids.end();
    if (!meant) continue;
    ++links_[i].messages_to;
    links_[i].stop_seq = stop.seq;
    world_.order(i, [&stop](dynamics::RobotCore& core, std::uint32_t now_ms) {
      stop.clear != 0 ? core.clearStop(now_ms) : core.stop(now_ms);
    });
  }
}

ServiceDescription serviceDescription() {
  return {.name = "sim_svc",
          .summary = "Simulated robots, arena and camera",
          .origin = robot_state_t::SIM,
          .make = [](const ServiceContext& context) -> std::unique_ptr<Service> {
            return std::make_unique<SimService>(context);
          }};
}

}  // namespace lab::sim
