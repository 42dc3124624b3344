/// Commands and layers of an experiment as messages.
#pragma once

#include <cstdint>
#include <lab/light_layer_t.hpp>
#include <lab/robot_command_t.hpp>
#include <lab/robot_order_t.hpp>
#include <string>
#include <vector>

#include "common/experiment/experiment.hpp"

namespace lab {

/// A command with the light table for every robot of the experiment; the header is empty.
[[nodiscard]] robot_command_t lightTableCommand(const Experiment& experiment);

/// A command that makes every robot of the experiment stand; the header is empty.
[[nodiscard]] robot_command_t standCommand(const Experiment& experiment);

/// The ids of the robots that take commands: all except replayed ones.
[[nodiscard]] std::vector<std::int32_t> commandedRobots(const Experiment& experiment);

/// `image` of the result is the path as written in the file; before sending it must be replaced by
/// the SHA-256 (ExperimentImages::digests).
[[nodiscard]] light_layer_t toMessage(const LayerSpec& layer);
[[nodiscard]] std::vector<light_layer_t> toMessages(const std::vector<LayerSpec>& layers);

}  // namespace lab
