#pragma once

#include <stdint.h>

namespace lab {
namespace dynamics {

/// The byte code of a program of motion (docs/programs.md).
///
/// A program is at most kLargestProgram bytes:
///
///     format, phases, start block, then for each phase: evaluation block, interruption block
///
/// A block is straight-line code for a stack machine: its length (1 byte) and its instructions.
/// There are no jumps, so every block ends after as many steps as it has instructions.
/// - The start block runs when the program starts. It sets the state variables, which are 0 before,
///   and leaves the stack empty.
/// - The evaluation block runs when its phase begins. It leaves four numbers: two speeds (kDrive or
///   kWheelSpeeds says which), the hold and the next phase.
/// - The interruption block (length 0: the phase has none) runs after each sensor scan during the
///   hold. It leaves two numbers: whether the hold ends now, and the phase that follows.
///
/// Numbers are fixed point (fixed_point.hpp). Truth values are 0 and 1, phases are 0 to
/// phases - 1, both as plain integers.
constexpr uint8_t kByteCodeFormat = 0x51;

constexpr uint8_t kLargestProgram = 176;  ///< [bytes]
constexpr uint8_t kLargestStack = 12;
constexpr uint8_t kStates = 8;
constexpr uint8_t kLargestPhases = 8;
constexpr uint8_t kSenses = 8;

/// The most that one block may cost on the robot [cycles]: 5 ms at 8 MHz.
constexpr uint16_t kLargestCost = 40000U;

/// Operands follow the opcode, least significant byte first. "a b -> c" is what an instruction
/// takes from the stack, the top last, and what it leaves there.
enum Opcode : uint8_t {
  kPushByte = 1,   ///< -> n: one signed byte, a whole number
  kPushShort = 2,  ///< -> n: two bytes, signed, in units of 2^-8
  kPushLong = 3,   ///< -> n: four bytes, signed, in units of 2^-16
  kPushPlain = 4,  ///< -> n: one byte, a plain integer (truth value or phase)
  kPushForever = 5,
  kLoad = 6,   ///< -> n: the state variable of the operand
  kStore = 7,  ///< n ->: to the state variable of the operand
  kRead = 8,   ///< -> n: the Input of the operand

  kAdd = 16,       ///< a b -> a + b
  kSubtract = 17,  ///< a b -> a - b
  kMultiply = 18,  ///< a b -> a b
  kDivide = 19,    ///< a b -> a / b
  kNegate = 20,    ///< a -> -a
  kAbs = 21,       ///< a -> |a|
  kSign = 22,      ///< a -> -1, 0 or 1
  kMin = 23,       ///< a b -> the smaller one
  kMax = 24,       ///< a b -> the larger one
  kSqrt = 25,      ///< a -> the square root
  kSin = 26,       ///< a -> sine
  kCos = 27,       ///< a -> cosine
  kAtan2 = 28,     ///< y x -> angle of the point (x, y)

  kLess = 32,          ///< a b -> a < b
  kLessOrEqual = 33,   ///< a b -> a <= b
  kGreater = 34,       ///< a b -> a > b
  kGreaterEqual = 35,  ///< a b -> a >= b
  kEqual = 36,         ///< a b -> a = b
  kNotEqual = 37,      ///< a b -> a and b differ
  kAnd = 38,           ///< p q -> p and q
  kOr = 39,            ///< p q -> p or q
  kNot = 40,           ///< p -> not p
  kSelect = 41,        ///< p a b -> a if p, otherwise b

  kUniform = 48,      ///< a b -> uniform between a and b
  kNormal = 49,       ///< m s -> normal with mean m and standard deviation s
  kExponential = 50,  ///< m -> exponential with mean m
  kPareto = 51,       ///< m e -> Pareto with minimum m and exponent e
  kChance = 52,       ///< p -> true with probability p
  kChanceOf = 53,     ///< -> true with the probability of the operand (four bytes, 2^-32)
  kChoose = 54,       ///< n -> one of 0, 1, ... n - 1 with equal probabilities

  kDrive = 64,       ///< Last in an evaluation block: the speeds are forward and turn.
  kWheelSpeeds = 65  ///< Last in an evaluation block: the speeds are those of left and right wheel.
};

/// What kRead reads.
enum Input : uint8_t {
  kLight = 0,       ///< Mean of both light sensors, 0 to 1.
  kLightFront = 1,  ///< 0 to 1
  kLightBack = 2,   ///< 0 to 1
  kBattery = 3,     ///< [V]
  kIr = 4,          ///< 4 to 9: the six infrared sensors, 0 to 1
  kTime = 10,       ///< Since the start of the program [s].
  kPhaseTime = 11,  ///< Since the beginning of the phase [s].
  kHeading = 12,    ///< Turned since the start of the program, in (-pi, pi] [rad].
  kDistance = 13,   ///< Driven since the start of the program [cm].
  kId = 14,         ///< The robot's number.
  kSense = 16       ///< 16 to 23: the numbers that the host writes
};

/// Whether kRead knows the input.
inline bool isInput(uint8_t input) {
  return input <= kId || (input >= kSense && input < kSense + kSenses);
}

/// What is wrong with a program.
enum ByteCodeFault : uint8_t {
  kValidByteCode = 0,
  kTooLong = 1,         ///< Longer than kLargestProgram, or shorter than a program can be.
  kOtherFormat = 2,     ///< The first byte is not kByteCodeFormat.
  kBadPhases = 3,       ///< No phase, or more than kLargestPhases.
  kBadBlock = 4,        ///< A block reaches beyond the program, or bytes follow the last block.
  kBadOpcode = 5,       ///< Not an instruction, or not allowed here.
  kBadOperand = 6,      ///< A state variable, input or operand that does not exist.
  kStackUnderflow = 7,  ///< An instruction takes more than there is.
  kStackOverflow = 8,   ///< More than kLargestStack numbers.
  kBadResult = 9,       ///< A block leaves another number of results than it must.
  kTooSlow = 10         ///< A block costs more than kLargestCost.
};

/// Where a program is wrong: the fault, and the position of the byte where it was found.
struct ByteCodeCheck {
  ByteCodeFault fault = kValidByteCode;
  uint8_t position = 0;
};

/// Checks any bytes. A program without a fault can be executed by Machine: it ends, reads and
/// writes nothing but its own stack and state, and costs at most kLargestCost a block.
ByteCodeCheck checkByteCode(const uint8_t* code, uint16_t size);

/// The number of bytes of an instruction with its operands; 0: there is no such instruction.
uint8_t instructionSize(uint8_t opcode);

/// The most cycles that an instruction takes on the robot; 0: there is no such instruction.
uint16_t instructionCost(uint8_t opcode);

/// The most cycles that a block of a valid program takes; `block` points to its length.
uint16_t blockCost(const uint8_t* block);

/// The CRC-32 (IEEE 802.3) of a program, by which host and robot name it; never 0.
uint32_t programHash(const uint8_t* code, uint8_t size);

}  // namespace dynamics
}  // namespace lab
