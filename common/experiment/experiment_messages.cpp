#include "common/experiment/experiment_messages.hpp"

#include <algorithm>
#include <tuple>

#include "common/experiment/experiment_conversions.hpp"
#include "common/experiment/light_messages.hpp"

namespace lab {
namespace {

auto parameters(const program_t& program) {
  return std::tie(program.kind, program.v, program.va, program.V, program.epsilon, program.eta,
                  program.gamma, program.tau_t, program.wheel_left, program.wheel_right);
}

robot_command_t commandEveryRobot(const Experiment& experiment, robot_order_t order) {
  order.robot_ids = commandedRobots(experiment);
  order.num_robots = static_cast<std::int32_t>(order.robot_ids.size());
  robot_command_t command{};
  const double lease = std::max(experiment.hardware.lease, experiment.hardware.free_run);
  command.lease_ms = static_cast<std::int32_t>(lease * 1000 + 0.5);
  command.orders.push_back(std::move(order));
  command.num_orders = 1;
  return command;
}

}  // namespace

std::vector<std::int32_t> commandedRobots(const Experiment& experiment) {
  std::vector<std::int32_t> ids;
  for (const RobotSpec& robot : experiment.robots) {
    if (robot.body != Body::kReplay) ids.push_back(robot.id);
  }
  return ids;
}

program_t toMessage(const ProgramSpec& program) {
  program_t message{};
  message.kind = static_cast<std::int8_t>(program.model);
  message.v = program.v;
  message.va = program.va;
  message.V = program.V;
  message.epsilon = program.epsilon;
  message.eta = program.eta;
  message.gamma = program.gamma;
  message.tau_t = program.tau_t;
  message.wheel_left = program.wheel_left;
  message.wheel_right = program.wheel_right;
  return message;
}

robot_command_t lightTableCommand(const Experiment& experiment) {
  robot_order_t order{};
  order.mode = robot_order_t::TABLE;
  order.light_sensor = static_cast<std::int8_t>(experiment.light_table.sensor);
  order.hysteresis = experiment.light_table.hysteresis;
  for (const LightBand& band : experiment.light_table.bands) {
    light_band_t message{};
    message.low = band.low;
    message.high = band.high;
    message.program = toMessage(experiment.programs.at(band.program));
    order.bands.push_back(message);
  }
  order.num_bands = static_cast<std::int8_t>(order.bands.size());
  order.reverse_on = static_cast<std::int8_t>(experiment.reversal.on);
  order.reverse_distance = experiment.reversal.distance;
  order.reverse_speed = experiment.reversal.speed;
  return commandEveryRobot(experiment, std::move(order));
}

robot_command_t standCommand(const Experiment& experiment) {
  robot_order_t order{};
  order.mode = robot_order_t::STAND;
  return commandEveryRobot(experiment, std::move(order));
}

light_layer_t toMessage(const LayerSpec& layer) {
  light_layer_t message = toMessage(toLightLayer(layer));
  message.image = layer.image;
  return message;
}

std::vector<light_layer_t> toMessages(const std::vector<LayerSpec>& layers) {
  std::vector<light_layer_t> messages;
  messages.reserve(layers.size());
  for (const LayerSpec& layer : layers) messages.push_back(toMessage(layer));
  return messages;
}

std::string programName(const Experiment& experiment, const program_t& program) {
  for (const auto& [name, spec] : experiment.programs) {
    if (sameProgram(toMessage(spec), program)) return name;
  }
  return modelName(program.kind);
}

std::string modelName(std::int8_t kind) {
  switch (kind) {
    case program_t::ABP:
      return "ABP";
    case program_t::NOISY_ABP:
      return "noisy ABP";
    case program_t::BP:
      return "BP";
    case program_t::RTP:
      return "RTP";
    case program_t::WHEELS:
      return "wheels";
    default:
      return "standing";
  }
}

bool sameProgram(const program_t& a, const program_t& b) { return parameters(a) == parameters(b); }

bool orderedBefore(const program_t& a, const program_t& b) { return parameters(a) < parameters(b); }

}  // namespace lab
