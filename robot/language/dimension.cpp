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

struct OtherUnit {
  std::string_view name;
  std::string_view instead;
};

constexpr std::array<OtherUnit, 37> kOtherUnits{{
    {"Hz", "1/s"},         {"hz", "1/s"},       {"kHz", "1/ms"},      {"km", "1000 m"},
    {"dm", "10 cm"},       {"nm", "0.001 um"},  {"inch", "2.54 cm"},  {"us", "0.001 ms"},
    {"ns", "0.000001 ms"}, {"sec", "s"},        {"second", "s"},      {"seconds", "s"},
    {"msec", "ms"},        {"minute", "min"},   {"minutes", "min"},   {"h", "60 min"},
    {"hour", "60 min"},    {"hours", "60 min"}, {"hr", "60 min"},     {"degree", "deg"},
    {"degrees", "deg"},    {"radian", "rad"},   {"radians", "rad"},   {"rev", "2*pi"},
    {"turn", "2*pi"},      {"turns", "2*pi"},   {"rpm", "2*pi/min"},  {"V", "volt"},
    {"Volt", "volt"},      {"volts", "volt"},   {"mV", "0.001 volt"}, {"meter", "m"},
    {"meters", "m"},       {"metre", "m"},      {"metres", "m"},      {"centimeter", "cm"},
    {"millimeter", "mm"},
}};

void addFactor(std::string& text, const char* unit, int exponent) {
  if (exponent == 0) {
    return;
  }
  text += text.empty() ? "" : "*";
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
  return above + '/' + (below.find('*') == std::string::npos ? below : '(' + below + ')');
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

std::string_view otherUnit(std::string_view name) {
  for (const OtherUnit& unit : kOtherUnits) {
    if (unit.name == name) {
      return unit.instead;
    }
  }
  return {};
}

std::string unitAdvice(std::string_view name) {
  const std::string_view instead = otherUnit(name);
  if (!instead.empty()) {
    return ": write " + std::string(instead) + " for it; the units are " + unitNames();
  }
  return ", expected a unit (" + unitNames() +
         "), an operator or the end; products are written with '*'";
}

}  // namespace lab::language
