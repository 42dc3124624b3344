/// What an experiment file asks for, as messages.
#pragma once

#include <cstdint>
#include <lab/light_layer_t.hpp>
#include <lab/program_t.hpp>
#include <lab/robot_command_t.hpp>
#include <lab/robot_order_t.hpp>
#include <string>
#include <vector>

#include "common/experiment/experiment.hpp"

namespace lab {

[[nodiscard]] program_t toMessage(const ProgramSpec& program);

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

/// The name that the experiment gives to this program, or its model's where it has none.
[[nodiscard]] std::string programName(const Experiment& experiment, const program_t& program);

/// "ABP", "noisy ABP", "BP", "RTP", "wheels", "standing".
[[nodiscard]] std::string modelName(std::int8_t kind);

/// Whether two programs are the same model with the same parameters.
[[nodiscard]] bool sameProgram(const program_t& a, const program_t& b);

/// Programs as keys of a map: by model, then parameter by parameter.
[[nodiscard]] bool orderedBefore(const program_t& a, const program_t& b);

}  // namespace lab
