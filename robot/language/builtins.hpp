/// The names that the language gives a meaning: functions, sensors, constants.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "robot/dynamics/byte_code.hpp"
#include "robot/language/dimension.hpp"

namespace lab::language {

struct BuiltinFunction {
  std::string_view name;
  std::size_t operands;
  std::string_view usage;  ///< "min(a, b)"
};

/// Null: there is no such function.
[[nodiscard]] const BuiltinFunction* functionNamed(std::string_view name);

/// What to write for a function of other languages; empty: it is none.
[[nodiscard]] std::string_view insteadOfFunction(std::string_view foreign);

[[nodiscard]] std::vector<std::string> functionNames();

/// A number that the robot measures, in the units of programs (cm, s, rad, volt).
struct Sensor {
  std::string_view name;
  dynamics::Input input;
  Dimension dimension;
  double low;
  double high;
};

/// Null: there is no such sensor. Those with a number, ir(i) and sense(i), are functions.
[[nodiscard]] const Sensor* sensorNamed(std::string_view name);

/// All names that the language gives a meaning, without units and words such as `and`.
[[nodiscard]] std::vector<std::string> builtinNames();

/// Whether the language gives this name a meaning, so that no program may. Of the functions only
/// `sign` is free: without a bracket it is a name, and a usual one.
[[nodiscard]] bool isReserved(std::string_view name);

/// What texts of programs call a dynamics::Input: "light", "ir(0)", "sense(3)".
[[nodiscard]] std::string inputName(std::uint8_t input);

}  // namespace lab::language
