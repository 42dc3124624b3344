#include "robot/language/builtins.hpp"

#include <algorithm>
#include <array>
#include <numbers>

#include "robot/dynamics/sensors.hpp"
#include "robot/language/interval.hpp"

namespace lab::language {
namespace {

constexpr std::array<BuiltinFunction, 18> kFunctions{{
    {"if", 3, "if(condition, then, otherwise)"},
    {"min", 2, "min(a, b)"},
    {"max", 2, "max(a, b)"},
    {"abs", 1, "abs(x)"},
    {"sign", 1, "sign(x)"},
    {"clamp", 3, "clamp(x, low, high)"},
    {"sqrt", 1, "sqrt(x)"},
    {"sin", 1, "sin(angle)"},
    {"cos", 1, "cos(angle)"},
    {"atan2", 2, "atan2(y, x)"},
    {"uniform", 2, "uniform(a, b)"},
    {"normal", 2, "normal(mean, deviation)"},
    {"exponential", 1, "exponential(mean)"},
    {"pareto", 2, "pareto(minimum, exponent)"},
    {"chance", 1, "chance(probability)"},
    {"choose", 1, "choose(n)"},
    {"ir", 1, "ir(0) to ir(5)"},
    {"sense", 1, "sense(0) to sense(7)"},
}};

/// The one function whose name a program may use: a direction of 1 or -1 is called so.
constexpr std::string_view kFreeFunction = "sign";

/// What other languages have, and what to write here.
struct ForeignFunction {
  std::string_view name;
  std::string_view instead;
};

constexpr std::array<ForeignFunction, 12> kForeignFunctions{{
    {"rand", "uniform(0, 1)"},
    {"random", "uniform(0, 1)"},
    {"gauss", "normal(mean, deviation)"},
    {"gaussian", "normal(mean, deviation)"},
    {"randn", "normal(mean, deviation)"},
    {"bernoulli", "chance(probability)"},
    {"tan", "sin(x)/cos(x)"},
    {"atan", "atan2(y, x)"},
    {"arctan", "atan2(y, x)"},
    {"exp", "it in a formula of law only"},
    {"log", "it in a formula of law only"},
    {"pow", "a product such as x*x, or pow(x, n) in a formula of law"},
}};

constexpr std::array<Sensor, 9> kSensors{{
    {"light", dynamics::kLight, kPure, 0, 1},
    {"light_front", dynamics::kLightFront, kPure, 0, 1},
    {"light_back", dynamics::kLightBack, kPure, 0, 1},
    {"battery", dynamics::kBattery, kVoltage, 0, 65.535},
    {"time", dynamics::kTime, kTime, 0, kLargestNumber},
    {"phase_time", dynamics::kPhaseTime, kTime, 0, kLargestNumber},
    {"heading", dynamics::kHeading, kPure, -std::numbers::pi, std::numbers::pi},
    {"distance", dynamics::kDistance, kLength, 0, kLargestNumber},
    {"id", dynamics::kId, kPure, 0, kLargestNumber},
}};

/// The entry of this name; null: there is none.
template <typename Table>
const typename Table::value_type* entryNamed(const Table& table, std::string_view name) {
  const auto found = std::ranges::find(table, name, &Table::value_type::name);
  return found == table.end() ? nullptr : &*found;
}

}  // namespace

const BuiltinFunction* functionNamed(std::string_view name) { return entryNamed(kFunctions, name); }

std::string_view insteadOfFunction(std::string_view foreign) {
  const ForeignFunction* found = entryNamed(kForeignFunctions, foreign);
  return found == nullptr ? std::string_view() : found->instead;
}

std::vector<std::string> functionNames() {
  std::vector<std::string> names;
  for (const BuiltinFunction& function : kFunctions) names.emplace_back(function.name);
  return names;
}

const Sensor* sensorNamed(std::string_view name) { return entryNamed(kSensors, name); }

std::vector<std::string> builtinNames() {
  std::vector<std::string> names{"pi", "forever"};
  for (const Sensor& sensor : kSensors) names.emplace_back(sensor.name);
  for (const BuiltinFunction& function : kFunctions) names.emplace_back(function.name);
  return names;
}

bool isReserved(std::string_view name) {
  constexpr std::array<std::string_view, 5> kWords{"and", "or", "not", "pi", "forever"};
  return unitNamed(name).has_value() || std::ranges::find(kWords, name) != kWords.end() ||
         (functionNamed(name) != nullptr && name != kFreeFunction) || sensorNamed(name) != nullptr;
}

std::string inputName(std::uint8_t input) {
  const auto numbered = [&](const char* name, int first) {
    return name + ("(" + std::to_string(input - first) + ")");
  };
  if (input >= dynamics::kSense) return numbered("sense", dynamics::kSense);
  if (input >= dynamics::kIr && input < dynamics::kIr + dynamics::kIrSensors) {
    return numbered("ir", dynamics::kIr);
  }
  for (const Sensor& sensor : kSensors) {
    if (sensor.input == input) return std::string(sensor.name);
  }
  return "?";
}

}  // namespace lab::language
