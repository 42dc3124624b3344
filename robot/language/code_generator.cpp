#include "robot/language/code_generator.hpp"

#include <algorithm>
#include <cmath>

#include "robot/dynamics/fixed_point.hpp"

namespace lab::language {
namespace {

void appendLittleEndian(std::uint32_t value, int bytes, std::vector<std::uint8_t>& code) {
  for (int i = 0; i < bytes; ++i) {
    code.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }
}

}  // namespace

std::int32_t toFixed(double value) {
  const double scaled = std::round(value * dynamics::kOne);
  return static_cast<std::int32_t>(std::clamp(scaled, static_cast<double>(dynamics::kSmallest),
                                              static_cast<double>(dynamics::kLargest)));
}

void BlockCode::add(std::uint8_t opcode, int taken, int left) {
  bytes_.push_back(opcode);
  depth_ += left - taken;
  deepest_ = std::max(deepest_, depth_);
  cost_ += dynamics::instructionCost(opcode);
}

void BlockCode::add(std::uint8_t opcode, std::uint8_t operand, int taken, int left) {
  add(opcode, taken, left);
  bytes_.push_back(operand);
}

void BlockCode::push(const CheckedExpression& expression) {
  if (expression.constant) {
    pushConstant(expression);
    return;
  }
  if (expression.opcode == dynamics::kChance && expression.children[0].constant) {
    pushProbability(expression.children[0].range.low);
    return;
  }
  for (const CheckedExpression& child : expression.children) {
    push(child);
  }
  if (expression.opcode == dynamics::kLoad || expression.opcode == dynamics::kRead) {
    add(expression.opcode, expression.operand, 0, 1);
  } else {
    add(expression.opcode, static_cast<int>(expression.children.size()), 1);
  }
}

// The shortest instruction that gives exactly this number.
void BlockCode::pushConstant(const CheckedExpression& constant) {
  if (constant.endless) {
    add(dynamics::kPushForever, 0, 1);
    return;
  }
  if (constant.type != Type::kNumber) {
    add(dynamics::kPushPlain, static_cast<std::uint8_t>(constant.range.low), 0, 1);
    return;
  }
  const std::int32_t value = toFixed(constant.range.low);
  if (value % dynamics::kOne == 0 && value / dynamics::kOne >= -128 &&
      value / dynamics::kOne <= 127) {
    add(dynamics::kPushByte, static_cast<std::uint8_t>(value / dynamics::kOne), 0, 1);
  } else if (value % 256 == 0 && value / 256 >= -32768 && value / 256 <= 32767) {
    add(dynamics::kPushShort, 0, 1);
    appendLittleEndian(static_cast<std::uint32_t>(value / 256), 2, bytes_);
  } else {
    add(dynamics::kPushLong, 0, 1);
    appendLittleEndian(static_cast<std::uint32_t>(value), 4, bytes_);
  }
}

// A probability that is known has 32 bits instead of the 16 of a number.
void BlockCode::pushProbability(double probability) {
  constexpr double kCertain = 4294967296.0;  // 2^32
  const double scaled = std::min(std::round(probability * kCertain), kCertain - 1);
  add(dynamics::kChanceOf, 0, 1);
  appendLittleEndian(static_cast<std::uint32_t>(scaled), 4, bytes_);
}

}  // namespace lab::language
