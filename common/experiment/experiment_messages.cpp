#include "common/experiment/experiment_messages.hpp"

#include <algorithm>

#include "common/experiment/light_messages.hpp"
#include "common/experiment/program_messages.hpp"

namespace lab {
namespace {

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

}  // namespace lab
