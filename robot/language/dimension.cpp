#include "robot/language/dimension.hpp"

#include <array>
#include <numbers>

namespace lab::language {
namespace {

struct NamedUnit {
  std::string_view name;
  Unit unit;
};

constexpr std::array<NamedUnit, 11> kUnits{{
    {"m", {100, kLength}},
    {"cm", {1, kLength}},
    {"mm", {0.1, kLength}},
    {"um", {1e-4, kLength}},
    {"s", {1, kTime}},
    {"ms", {1e-3, kTime}},
    {"min", {60, kTime}},
    {"rad", {1, kPure}},
    {"deg", {std::numbers::pi / 180, kPure}},
    {"percent", {0.01, kPure}},
    {"volt", {1, kVoltage}},
}};

void addFactor(std::string& text, const char* unit, int exponent) {
  if (exponent == 0) {
    return;
  }
  text += text.empty() ? "" : " ";
  text += unit;
  if (exponent > 1) {
    text += '^' + std::to_string(exponent);
  }
}

}  // namespace

Dimension product(const Dimension& a, const Dimension& b) {
  return {a.length + b.length, a.time + b.time, a.voltage + b.voltage};
}

Dimension quotient(const Dimension& a, const Dimension& b) {
  return {a.length - b.length, a.time - b.time, a.voltage - b.voltage};
}

std::optional<Dimension> squareRoot(const Dimension& a) {
  if (a.length % 2 != 0 || a.time % 2 != 0 || a.voltage % 2 != 0) {
    return std::nullopt;
  }
  return Dimension{a.length / 2, a.time / 2, a.voltage / 2};
}

std::string unitText(const Dimension& dimension) {
  std::string above;
  std::string below;
  const std::array<std::pair<const char*, int>, 3> factors{
      {{"cm", dimension.length}, {"s", dimension.time}, {"volt", dimension.voltage}}};
  for (const auto& [unit, exponent] : factors) {
    addFactor(exponent > 0 ? above : below, unit, exponent > 0 ? exponent : -exponent);
  }
  if (above.empty()) {
    above = "1";
  }
  if (below.empty()) {
    return above;
  }
  return above + '/' + (below.find(' ') == std::string::npos ? below : '(' + below + ')');
}

std::optional<Unit> unitNamed(std::string_view name) {
  for (const NamedUnit& candidate : kUnits) {
    if (candidate.name == name) {
      return candidate.unit;
    }
  }
  return std::nullopt;
}

std::string unitNames() {
  std::string names;
  for (const NamedUnit& unit : kUnits) {
    names += (names.empty() ? "" : ", ") + std::string(unit.name);
  }
  return names;
}

}  // namespace lab::language
