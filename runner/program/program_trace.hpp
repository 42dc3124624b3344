/// The first holds of a program, as a robot executes them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robot/dynamics/machine.hpp"
#include "robot/language/compiler.hpp"

namespace lab::runner {

/// A random draw and what it gave.
struct TracedDraw {
  std::uint8_t opcode = 0;
  dynamics::Fixed result = 0;  ///< of kChance and kChanceOf 0 or 1
};

struct TracedHold {
  std::uint32_t begin_ms = 0;                ///< since the start of the program
  std::optional<std::uint32_t> duration_ms;  ///< as long as it lasted; nothing: without end
  bool interrupted = false;                  ///< `until` ended it
  bool limited = false;                      ///< a result or a wheel speed was limited
  std::uint8_t phase = 0;
  std::int32_t left_um_s = 0;
  std::int32_t right_um_s = 0;
  std::vector<dynamics::Fixed> states;
  std::vector<TracedDraw> start_draws;         ///< of the values that the state starts with
  std::vector<TracedDraw> draws;               ///< of its evaluation
  std::vector<TracedDraw> interruption_draws;  ///< of the `until` that ended it
};

/// What the sensors of a traced robot read, all the time.
struct TraceInputs {
  dynamics::Sensors sensors;  ///< [counts]
  std::uint16_t battery_mv = 7400;
  std::uint16_t id = 1;
  dynamics::Fixed senses[dynamics::kSenses] = {};
};

/// Sets an input by its name in programs: "light=0.5" (both sensors), "light_front=0.5", "ir(0)=1",
/// "sense(3)=8", "battery=7.4", "id=4".
/// @throws UserError for an unknown name, and for a value outside its range
void setInput(TraceInputs& inputs, std::string_view setting);

/// Executes a program on the robot's own core (dynamics::RobotCore), with a scan of the sensors
/// every 20 ms. Ends after `holds` holds, and with one that lasts for more than an hour.
[[nodiscard]] std::vector<TracedHold> traceHolds(const language::CompiledProgram& program,
                                                 const TraceInputs& inputs, std::uint64_t seed,
                                                 int holds);

/// The holds as a table.
[[nodiscard]] std::string traceTable(const language::CompiledProgram& program,
                                     const std::vector<TracedHold>& holds);

}  // namespace lab::runner
