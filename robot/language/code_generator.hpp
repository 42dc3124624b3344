#pragma once

#include <cstdint>
#include <vector>

#include "robot/language/checked_expression.hpp"

namespace lab::language {

/// Byte code of one block, with what it needs.
class BlockCode {
 public:
  /// Appends the code that leaves the expression's value on the stack.
  void push(const CheckedExpression& expression);

  /// Appends an instruction that takes `taken` numbers from the stack and leaves `left`.
  void add(std::uint8_t opcode, int taken, int left);
  void add(std::uint8_t opcode, std::uint8_t operand, int taken, int left);

  [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }
  [[nodiscard]] int deepestStack() const { return deepest_; }
  [[nodiscard]] unsigned cost() const { return cost_; }  ///< [cycles on the robot]

 private:
  void pushConstant(const CheckedExpression& constant);
  void pushProbability(double probability);

  std::vector<std::uint8_t> bytes_;
  int depth_ = 0;
  int deepest_ = 0;
  unsigned cost_ = 0;
};

/// A value in the robot's numbers, rounded to the nearest one.
[[nodiscard]] std::int32_t toFixed(double value);

}  // namespace lab::language
