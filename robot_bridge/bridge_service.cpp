#include "robot_bridge/bridge_service.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <lab/robot_status_t.hpp>
#include <lab/robot_steps_t.hpp>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/experiment/service_placement.hpp"
#include "common/math/units.hpp"
#include "common/programs/fixed_of.hpp"

namespace lab::bridge {
namespace {

constexpr std::int64_t kTick_us = 20'000;
constexpr std::int64_t kSilent_us = 1'000'000;

bool isServed(const RobotSpec& robot) { return isOnWire(robot.body); }

std::uint32_t uidOf(const RobotSpec& robot) {
  return robot.body == Body::kSerial ? robot.uid : simulatedUid(robot.id);
}

/// The period of ROBOT_STATUS, limited so that telemetry takes at most a quarter of the line.
/// @return ms
std::uint32_t telemetryPeriod(double rate, int baud) {
  const long requested = std::lround(1000 / rate);
  const long shortest = baud >= 500000 ? 20 : std::lround(50.0 * 38400 / baud);
  return static_cast<std::uint32_t>(std::clamp(requested, shortest, 60000L));
}

LinkSettings linkSettings(const Experiment& experiment, const RobotSpec& robot) {
  LinkSettings settings;
  settings.id = robot.id;
  settings.simulated = isSimulated(robot.body);
  settings.seed = experiment.seed;
  settings.max_wheel_speed = experiment.hardware.max_wheel_speed;
  settings.sensor_period = experiment.hardware.sensor_period;
  settings.wheel_base = experiment.hardware.diameter;
  settings.resume_after_reboot = experiment.hardware.resume_after_reboot;
  settings.baud = experiment.serial.baud;
  settings.telemetry_period_ms =
      telemetryPeriod(experiment.hardware.status_rate, experiment.serial.baud);
  return settings;
}

PortSettings portSettings(const Experiment& experiment) {
  PortSettings settings;
  settings.baud = experiment.serial.baud;
  for (const RobotSpec& robot : experiment.robots) {
    if (robot.body == Body::kSerial) settings.patterns = experiment.serial.ports;
    if (robot.body == Body::kWire || robot.body == Body::kFirmware) settings.offered = true;
  }
  return settings;
}

}  // namespace

BridgeService::BridgeService(const ServiceContext& context)
    : node_(context.node),
      loop_(context.loop),
      experiment_(context.experiment),
      port_manager_(context.loop, context.ports, portSettings(context.experiment), byUid(),
                    [this](const std::string& text) { node_.noteError(text); }) {
  node_.subscribe<robot_command_t>(channels::kRobotCommand,
                                   [this](const robot_command_t& command) { handle(command); });
  node_.subscribe<robot_stop_t>(channels::kRobotStop,
                                [this](const robot_stop_t& stop) { handle(stop); });
  node_.subscribe<robot_calibration_t>(
      channels::kRobotCalibration, [this](const robot_calibration_t& request) { handle(request); });
  node_.subscribe<robot_senses_t>(channels::kRobotSenses,
                                  [this](const robot_senses_t& senses) { handle(senses); });
  const auto period_us = std::llround(1e6 / experiment_.hardware.status_rate);
  loop_.every(kTick_us, loop_.now() + kTick_us, [this] { tick(); });
  loop_.every(period_us, loop_.now() + period_us, [this] { publish(); });
  loop_.every(units::kSecond_us, loop_.now(), [this] { reportLines(); });
  loop_.soon([this] {
    tick();
    node_.ready();
  });
}

PortManager::Robots BridgeService::byUid() {
  PortManager::Robots by_uid;
  for (const RobotSpec& robot : experiment_.robots) {
    if (!isServed(robot)) continue;
    const std::int8_t origin =
        robot.body == Body::kSerial ? robot_state_t::REAL : robot_state_t::SIM;
    const auto entry =
        robots_.try_emplace(robot.id, linkSettings(experiment_, robot), origin).first;
    by_uid[uidOf(robot)] = &entry->second.link;
  }
  return by_uid;
}

void BridgeService::handle(const robot_command_t& command) {
  const std::int64_t now = loop_.now();
  for (const robot_order_t& order : command.orders) {
    for (const std::int32_t id : order.robot_ids) {
      const auto robot = robots_.find(id);
      if (robot == robots_.end()) continue;
      robot->second.link.command(command.seq, command.instance, command.lease_ms, order, now);
    }
  }
  port_manager_.flush();
}

void BridgeService::handle(const robot_stop_t& stop) {
  const std::int64_t now = loop_.now();
  const bool stops_all = stop.robot_ids.empty();
  for (auto& [id, robot] : robots_) {
    const bool meant = stops_all || std::find(stop.robot_ids.begin(), stop.robot_ids.end(), id) !=
                                        stop.robot_ids.end();
    if (meant) robot.link.stop(stop.seq, stop.clear != 0, now);
  }
  port_manager_.flush();
}

// Writing takes several messages to the robot, so the answer to a request follows when the request
// is repeated; it lists the robots that are ready by then.
void BridgeService::handle(const robot_calibration_t& request) {
  robot_calibration_t answer{};
  answer.seq = request.seq;
  for (const motor_calibration_t& requested : request.robots) {
    const auto robot = robots_.find(requested.robot_id);
    if (robot == robots_.end()) continue;
    RobotLink& link = robot->second.link;
    link.calibrate(request.seq, request.instance, requested, loop_.now());
    if (const auto held = link.calibration()) answer.robots.push_back(*held);
  }
  port_manager_.flush();
  if (answer.robots.empty()) return;
  answer.num_robots = static_cast<std::int32_t>(answer.robots.size());
  node_.publishCommand(channels::kCalibrationStatus, answer);
}

void BridgeService::handle(const robot_senses_t& senses) {
  for (const sense_values_t& sensed : senses.robots) {
    const auto robot = robots_.find(sensed.robot_id);
    if (robot == robots_.end()) continue;
    std::array<dynamics::Fixed, dynamics::kSenses> values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = fixedOf(static_cast<double>(sensed.values[i]));
    }
    robot->second.link.sense(values, senses.utime, loop_.now());
  }
  port_manager_.flush();
}

void BridgeService::tick() {
  port_manager_.tick();
  const std::int64_t now = loop_.now();
  for (auto& [id, robot] : robots_) {
    const bool silent = robot.link.isPlugged() && now - robot.link.heardUtime() > kSilent_us;
    if (silent && !robot.silent) {
      node_.noteError(port_manager_.lineOf(robot.link) + ": robot " + std::to_string(id) +
                      " is silent; is it switched on?");
    }
    robot.silent = silent;
    for (const std::string& text : robot.link.takeNotes()) node_.noteError(text);
  }
}

// Adds one row per serial line to the statistics of message losses.
void BridgeService::reportLines() {
  std::vector<stream_count_t> rows;
  for (auto& [id, robot] : robots_) {
    const LinkCounters& counters = robot.link.counters();
    const RobotView& view = robot.link.view();
    stream_count_t row{};
    row.channel = "serial line";
    row.sender = fmt::format("robot {} ({} restarts, {} commands sent again, {} given up", id,
                             counters.reboots, counters.retries, counters.failed);
    if (counters.programs_loaded > 0) {
      row.sender += fmt::format(", {} programs loaded in {:.1f} s", counters.programs_loaded,
                                static_cast<double>(counters.loading_us) * 1e-6);
    }
    row.sender += ')';
    row.instance = node_.identity().instance;
    row.received = counters.received;
    row.lost = view.telemetryLost() + view.stepsLost();
    row.decode_errors = counters.errors + view.framesBad();
    rows.push_back(std::move(row));
  }
  node_.reportStreams(std::move(rows));
}

void BridgeService::publish() {
  const std::int64_t now = loop_.now();
  robot_status_t status{};
  robot_steps_t steps{};
  bool any_update = false;
  for (auto& [id, robot] : robots_) {
    for (const RobotView::UnwrappedStep& step : robot.link.view().takeSteps()) {
      steps.steps.push_back(stepOf(robot.link, step));
    }
    if (now - robot.link.heardUtime() > kSilent_us) continue;
    const bool updated = robot.link.view().takeUpdateFlag();
    any_update = any_update || updated;
    const auto state = statusOf(robot.link, robot.origin, robot.reported);
    if (state) status.robots.push_back(*state);
  }
  if (any_update) {
    status.num_robots = static_cast<std::int32_t>(status.robots.size());
    node_.publish(channels::kRobotStatus, status);
  }
  if (!steps.steps.empty()) {
    steps.num_steps = static_cast<std::int32_t>(steps.steps.size());
    node_.publish(channels::kRobotSteps, steps);
  }
}

ServiceDescription serviceDescription() {
  ServiceDescription description;
  description.name = "robot_bridge";
  description.summary =
      "Robots on serial lines: finds them, sends them orders, publishes their state";
  description.make = [](const ServiceContext& context) -> std::unique_ptr<Service> {
    return std::make_unique<BridgeService>(context);
  };
  description.uses_ports = usesPorts(description.name);
  return description;
}

}  // namespace lab::bridge
