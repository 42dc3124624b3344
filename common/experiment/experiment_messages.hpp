/// What an experiment file asks for, as messages.
#pragma once

#include <cstdint>
#include <lab/light_layer_t.hpp>
#include <lab/robot_command_t.hpp>
#include <lab/robot_order_t.hpp>
#include <string>
#include <vector>

#include "common/experiment/experiment.hpp"

namespace lab {

/// One command that puts every robot of the experiment under its light table (header left empty).
[[nodiscard]] robot_command_t lightTableCommand(const Experiment& experiment);

/// One command that makes every robot of the experiment stand (header left empty).
[[nodiscard]] robot_command_t standCommand(const Experiment& experiment);

/// The robots that take orders: all but those replayed.
[[nodiscard]] std::vector<std::int32_t> commandedRobots(const Experiment& experiment);

/// The image of a layer is its path as written in the file; on the bus it travels as its SHA-256
/// (ExperimentImages::digests).
[[nodiscard]] light_layer_t toMessage(const LayerSpec& layer);
[[nodiscard]] std::vector<light_layer_t> toMessages(const std::vector<LayerSpec>& layers);

}  // namespace lab
