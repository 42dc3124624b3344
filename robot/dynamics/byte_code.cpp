#include "robot/dynamics/byte_code.hpp"

#include "robot/dynamics/flash.hpp"

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

/// An instruction in 16 bits: 3 for the numbers that it takes, 2 for its operands (0, 1, 2 or 4),
/// 11 for its cost in units of 10 cycles.
constexpr uint16_t entry(unsigned taken, unsigned operands, unsigned cost) {
  return static_cast<uint16_t>(taken << 13 | (operands == 4 ? 3U : operands) << 11 | cost / 10U);
}

constexpr uint8_t kOpcodes = kWheelSpeeds + 1;

// The costs are the largest ones of the compiled firmware on a simulated ATmega328P, over random
// and extreme operands, and a tenth more.
const uint16_t kInstructions[kOpcodes] LAB_IN_FLASH = {
    0,
    entry(0, 1, 90),    // kPushByte
    entry(0, 2, 90),    // kPushShort
    entry(0, 4, 90),    // kPushLong
    entry(0, 1, 90),    // kPushPlain
    entry(0, 0, 70),    // kPushForever
    entry(0, 1, 90),    // kLoad
    entry(1, 1, 90),    // kStore
    entry(0, 1, 1650),  // kRead
    0,
    0,
    0,
    0,
    0,
    0,
    0,
    entry(2, 0, 270),   // kAdd
    entry(2, 0, 270),   // kSubtract
    entry(2, 0, 560),   // kMultiply
    entry(2, 0, 1460),  // kDivide
    entry(1, 0, 90),    // kNegate
    entry(1, 0, 90),    // kAbs
    entry(1, 0, 90),    // kSign
    entry(2, 0, 150),   // kMin
    entry(2, 0, 150),   // kMax
    entry(1, 0, 8090),  // kSqrt
    entry(1, 0, 3070),  // kSin
    entry(1, 0, 3070),  // kCos
    entry(2, 0, 5700),  // kAtan2
    0,
    0,
    0,
    entry(2, 0, 160),  // kLess
    entry(2, 0, 160),  // kLessOrEqual
    entry(2, 0, 160),  // kGreater
    entry(2, 0, 160),  // kGreaterEqual
    entry(2, 0, 160),  // kEqual
    entry(2, 0, 160),  // kNotEqual
    entry(2, 0, 160),  // kAnd
    entry(2, 0, 160),  // kOr
    entry(1, 0, 90),   // kNot
    entry(3, 0, 100),  // kSelect
    0,
    0,
    0,
    0,
    0,
    0,
    entry(2, 0, 1440),   // kUniform
    entry(2, 0, 13730),  // kNormal
    entry(1, 0, 1810),   // kExponential
    entry(2, 0, 5880),   // kPareto
    entry(1, 0, 870),    // kChance
    entry(0, 4, 860),    // kChanceOf
    entry(1, 0, 1180),   // kChoose
    0,
    0,
    0,
    0,
    0,
    0,
    0,
    0,
    0,
    entry(4, 0, 2110),  // kDrive
    entry(4, 0, 2110),  // kWheelSpeeds
};

Instruction instruction(uint8_t opcode) {
  const uint16_t bits = opcode < kOpcodes ? readFlash(&kInstructions[opcode]) : 0U;
  const uint8_t operands = static_cast<uint8_t>((bits >> 11) & 3U);
  Instruction step;
  step.taken = static_cast<uint8_t>(bits >> 13);
  step.left = opcode == kStore ? 0 : step.taken == 4 ? 4 : 1;
  step.operands = operands == 3 ? 4 : operands;
  step.cost = static_cast<uint16_t>((bits & 0x7FFU) * 10U);
  return step;
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

uint16_t blockCost(const uint8_t* block) {
  const uint8_t* const end = block + 1 + block[0];
  uint16_t cost = 0;
  for (const uint8_t* at = block + 1; at < end;) {
    const Instruction step = instruction(*at);
    cost = static_cast<uint16_t>(cost + step.cost);
    at += 1 + step.operands;
  }
  return cost;
}

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
