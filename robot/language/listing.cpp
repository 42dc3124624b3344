#include "robot/language/listing.hpp"

#include <array>
#include <cstdio>
#include <string_view>
#include <utility>

#include "robot/dynamics/byte_code.hpp"
#include "robot/dynamics/fixed_point.hpp"
#include "robot/language/builtins.hpp"

namespace lab::language {
namespace {

using namespace dynamics;

constexpr std::array<std::pair<Opcode, std::string_view>, 38> kNames{{
    {kPushByte, "push"},
    {kPushShort, "push"},
    {kPushLong, "push"},
    {kPushPlain, "push phase"},
    {kPushForever, "push forever"},
    {kLoad, "load"},
    {kStore, "store"},
    {kRead, "read"},
    {kAdd, "add"},
    {kSubtract, "subtract"},
    {kMultiply, "multiply"},
    {kDivide, "divide"},
    {kNegate, "negate"},
    {kAbs, "abs"},
    {kSign, "sign"},
    {kMin, "min"},
    {kMax, "max"},
    {kSqrt, "sqrt"},
    {kSin, "sin"},
    {kCos, "cos"},
    {kAtan2, "atan2"},
    {kLess, "less"},
    {kLessOrEqual, "less or equal"},
    {kGreater, "greater"},
    {kGreaterEqual, "greater or equal"},
    {kEqual, "equal"},
    {kNotEqual, "not equal"},
    {kAnd, "and"},
    {kOr, "or"},
    {kNot, "not"},
    {kSelect, "select"},
    {kUniform, "uniform"},
    {kNormal, "normal"},
    {kExponential, "exponential"},
    {kPareto, "pareto"},
    {kChance, "chance"},
    {kChanceOf, "chance of"},
    {kChoose, "choose"},
}};

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

/// The unsigned number in `size` bytes, the least significant one first.
std::uint32_t littleEndian(std::span<const std::uint8_t> code, std::size_t at, int size) {
  std::uint32_t value = 0;
  for (int i = 0; i < size; ++i) {
    value |= static_cast<std::uint32_t>(code[at + static_cast<std::size_t>(i)]) << (8 * i);
  }
  return value;
}

/// The name with this number; without one the number.
std::string nameOf(const std::vector<std::string>& names, std::uint8_t index) {
  return index < names.size() ? names[index] : std::to_string(index);
}

std::string operandText(std::span<const std::uint8_t> code, std::size_t at,
                        const ListedNames& names) {
  switch (code[at]) {
    case kPushByte:
      return ' ' + number(static_cast<std::int8_t>(code[at + 1]));
    case kPushShort:
      return ' ' + number(static_cast<std::int16_t>(littleEndian(code, at + 1, 2)) / 256.0);
    case kPushLong:
      return ' ' + number(static_cast<std::int32_t>(littleEndian(code, at + 1, 4)) /
                          static_cast<double>(kOne));
    case kChanceOf:
      return ' ' + number(littleEndian(code, at + 1, 4) / 4294967296.0);
    case kPushPlain:  // the compiler writes no constant truth values
      return ' ' + nameOf(names.phases, code[at + 1]);
    case kLoad:
    case kStore:
      return ' ' + nameOf(names.states, code[at + 1]);
    case kRead:
      return ' ' + inputName(code[at + 1]);
    default:
      return "";
  }
}

}  // namespace

std::string instructionName(std::uint8_t opcode) {
  if (opcode == kDrive) return "drive: forward, turn, hold, next";
  if (opcode == kWheelSpeeds) return "drive: left, right, hold, next";
  for (const auto& [code, name] : kNames) {
    if (code == opcode) return std::string(name);
  }
  return "?";
}

std::vector<ListedBlock> listing(std::span<const std::uint8_t> code, const ListedNames& names) {
  std::vector<ListedBlock> blocks;
  std::size_t at = 2;
  for (int number = 0; number < 1 + 2 * code[1]; ++number) {
    ListedBlock block;
    block.title =
        number == 0 ? "start"
                    : "phase " + nameOf(names.phases, static_cast<std::uint8_t>((number - 1) / 2));
    if (number > 0 && number % 2 == 0) block.title += ", until";
    const std::size_t end = at + 1 + code[at];
    for (++at; at < end; at += instructionSize(code[at])) {
      block.instructions.push_back({static_cast<unsigned>(at),
                                    instructionName(code[at]) + operandText(code, at, names),
                                    instructionCost(code[at])});
    }
    if (!block.instructions.empty()) blocks.push_back(std::move(block));
  }
  return blocks;
}

}  // namespace lab::language
