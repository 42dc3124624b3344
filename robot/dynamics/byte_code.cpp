#include "robot/dynamics/byte_code.hpp"

namespace lab {
namespace dynamics {
namespace {

/// What an instruction takes from the stack and leaves there, its operand bytes, and its cost.
struct Instruction {
  uint8_t taken;
  uint8_t left;
  uint8_t operands;
  uint16_t cost;  ///< [cycles]; 0: no such instruction
};

// The costs are the largest ones of the compiled firmware on a simulated ATmega328P, over random
// and extreme operands, and a tenth more.
Instruction instruction(uint8_t opcode) {
  switch (opcode) {
    case kPushByte:
    case kPushPlain:
    case kLoad:
      return {0, 1, 1, 110};
    case kPushShort:
      return {0, 1, 2, 110};
    case kPushLong:
      return {0, 1, 4, 110};
    case kPushForever:
      return {0, 1, 0, 90};
    case kStore:
      return {1, 0, 1, 110};
    case kRead:
      return {0, 1, 1, 1900};
    case kAdd:
    case kSubtract:
      return {2, 1, 0, 260};
    case kMultiply:
      return {2, 1, 0, 500};
    case kDivide:
      return {2, 1, 0, 2200};
    case kNegate:
    case kAbs:
    case kSign:
    case kNot:
      return {1, 1, 0, 100};
    case kMin:
    case kMax:
    case kLess:
    case kLessOrEqual:
    case kGreater:
    case kGreaterEqual:
    case kEqual:
    case kNotEqual:
    case kAnd:
    case kOr:
      return {2, 1, 0, 180};
    case kSqrt:
      return {1, 1, 0, 7500};
    case kSin:
    case kCos:
      return {1, 1, 0, 3300};
    case kAtan2:
      return {2, 1, 0, 6700};
    case kSelect:
      return {3, 1, 0, 120};
    case kUniform:
      return {2, 1, 0, 1500};
    case kNormal:
      return {2, 1, 0, 13500};
    case kExponential:
      return {1, 1, 0, 2500};
    case kPareto:
      return {2, 1, 0, 7000};
    case kChance:
      return {1, 1, 0, 900};
    case kChanceOf:
      return {0, 1, 4, 900};
    case kChoose:
      return {1, 1, 0, 1300};
    case kDrive:
    case kWheelSpeeds:
      return {4, 4, 0, 1200};
    default:
      return {0, 0, 0, 0};
  }
}

enum BlockKind : uint8_t { kStartBlock, kEvaluation, kInterruption };

bool operandExists(uint8_t opcode, uint8_t operand) {
  switch (opcode) {
    case kLoad:
    case kStore:
      return operand < kStates;
    case kRead:
      return isInput(operand);
    default:
      return true;
  }
}

ByteCodeCheck fault(ByteCodeFault kind, uint16_t position) {
  ByteCodeCheck check;
  check.fault = kind;
  check.position = static_cast<uint8_t>(position);
  return check;
}

/// Checks the instructions in code[begin, end).
ByteCodeCheck checkBlock(const uint8_t* code, uint16_t begin, uint16_t end, BlockKind kind) {
  uint8_t depth = 0;
  uint16_t cost = 0;
  bool ended = false;
  uint16_t at = begin;
  while (at < end) {
    const uint8_t opcode = code[at];
    const Instruction step = instruction(opcode);
    const bool last = opcode == kDrive || opcode == kWheelSpeeds;
    if (step.cost == 0 || ended || (last && kind != kEvaluation)) {
      return fault(kBadOpcode, at);
    }
    if (at + 1U + step.operands > end ||
        (step.operands == 1 && !operandExists(opcode, code[at + 1U]))) {
      return fault(kBadOperand, at);
    }
    if (depth < step.taken) {
      return fault(kStackUnderflow, at);
    }
    depth = static_cast<uint8_t>(depth - step.taken + step.left);
    if (depth > kLargestStack) {
      return fault(kStackOverflow, at);
    }
    if (step.cost > kLargestCost - cost) {
      return fault(kTooSlow, at);
    }
    cost = static_cast<uint16_t>(cost + step.cost);
    ended = last;
    at = static_cast<uint16_t>(at + 1U + step.operands);
  }
  const uint8_t results = kind == kStartBlock ? 0 : kind == kEvaluation ? 4 : 2;
  if (depth != results || ended != (kind == kEvaluation)) {
    return fault(kBadResult, end);
  }
  return ByteCodeCheck();
}

}  // namespace

ByteCodeCheck checkByteCode(const uint8_t* code, uint16_t size) {
  if (size < 3 || size > kLargestProgram) {
    return fault(kTooLong, 0);
  }
  if (code[0] != kByteCodeFormat) {
    return fault(kOtherFormat, 0);
  }
  const uint8_t phases = code[1];
  if (phases == 0 || phases > kLargestPhases) {
    return fault(kBadPhases, 1);
  }
  uint16_t at = 2;
  for (uint8_t block = 0; block < 1 + 2 * phases; ++block) {
    if (at >= size || at + 1U + code[at] > size) {
      return fault(kBadBlock, at);
    }
    const uint16_t end = static_cast<uint16_t>(at + 1U + code[at]);
    const BlockKind kind = block == 0 ? kStartBlock : block % 2 == 1 ? kEvaluation : kInterruption;
    const bool absent = kind == kInterruption && code[at] == 0;
    const ByteCodeCheck check = absent ? ByteCodeCheck() : checkBlock(code, at + 1U, end, kind);
    if (check.fault != kValidByteCode) {
      return check;
    }
    at = end;
  }
  return at == size ? ByteCodeCheck() : fault(kBadBlock, at);
}

uint8_t instructionSize(uint8_t opcode) {
  const Instruction step = instruction(opcode);
  return step.cost == 0 ? 0 : static_cast<uint8_t>(1 + step.operands);
}

uint16_t instructionCost(uint8_t opcode) { return instruction(opcode).cost; }

uint32_t programHash(const uint8_t* code, uint8_t size) {
  uint32_t crc = 0xFFFFFFFFUL;
  for (uint8_t i = 0; i < size; ++i) {
    crc ^= code[i];
    for (uint8_t bit = 0; bit < 8; ++bit) {
      crc = (crc & 1U) != 0 ? (crc >> 1) ^ 0xEDB88320UL : crc >> 1;
    }
  }
  crc = ~crc;
  return crc == 0 ? 1 : crc;
}

}  // namespace dynamics
}  // namespace lab
