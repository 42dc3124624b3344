// Runs every instruction of programs of motion on the chip, for instruction_costs_test.cpp. Port B
// shows 0x80 when a block begins, and the opcode when it has ended; first without the instruction,
// then with it, on the same operands. 0x7F is a whole evaluation near the largest cost, 0x81 the
// end.
#include <avr/io.h>

#include "robot/dynamics/machine.hpp"

using namespace lab::dynamics;

namespace {

constexpr uint8_t kRepetitions = 60;
constexpr uint8_t kWorstEvaluation = 0x7F;

struct Case {
  uint8_t opcode;
  uint8_t taken;  // numbers from the stack
};

const Case kCases[] = {
    {kPushByte, 0}, {kPushShort, 0}, {kPushLong, 0},    {kPushPlain, 0},   {kPushForever, 0},
    {kLoad, 0},     {kStore, 1},     {kRead, 0},        {kAdd, 2},         {kSubtract, 2},
    {kMultiply, 2}, {kDivide, 2},    {kNegate, 1},      {kAbs, 1},         {kSign, 1},
    {kMin, 2},      {kMax, 2},       {kSqrt, 1},        {kSin, 1},         {kCos, 1},
    {kAtan2, 2},    {kLess, 2},      {kLessOrEqual, 2}, {kGreater, 2},     {kGreaterEqual, 2},
    {kEqual, 2},    {kNotEqual, 2},  {kAnd, 2},         {kOr, 2},          {kNot, 1},
    {kSelect, 3},   {kUniform, 2},   {kNormal, 2},      {kExponential, 1}, {kPareto, 2},
    {kChance, 1},   {kChanceOf, 0},  {kChoose, 1}};

const uint8_t kInputs[] = {kLight,     kLightFront, kBattery,  kIr, kTime,
                           kPhaseTime, kHeading,    kDistance, kId, kSense};

uint32_t random_state = 12345;

uint32_t randomBits() {
  random_state = random_state * 1664525UL + 1013904223UL;
  return random_state ^ (random_state >> 15);
}

uint32_t operand(uint8_t repetition) {
  switch (repetition) {
    case 0:
      return 0x7FFFFFFFUL;
    case 1:
      return 0x80000001UL;
    case 2:
      return 0;
    case 3:
      return 1;
    case 4:
      return 65536UL;
    default:
      return randomBits() >> (randomBits() >> 27);  // of all sizes
  }
}

uint8_t* pushLong(uint8_t* at, uint32_t value) {
  *at++ = kPushLong;
  for (uint8_t byte = 0; byte < 4; ++byte) {
    *at++ = static_cast<uint8_t>(value >> (8 * byte));
  }
  return at;
}

uint8_t code[kLargestProgram + 4];
Machine machine;
Rng rng;
MachineInputs inputs;

void run(const Case& one, uint8_t repetition, bool with) {
  uint8_t* at = code;
  *at++ = kByteCodeFormat;
  *at++ = 1;
  uint8_t* const length = at++;
  for (uint8_t i = 0; i < one.taken; ++i) {
    at = pushLong(at, operand(repetition));
  }
  if (with) {
    *at++ = one.opcode;
    const uint8_t operands = static_cast<uint8_t>(instructionSize(one.opcode) - 1);
    for (uint8_t i = 0; i < operands; ++i) {
      *at++ = one.opcode == kRead ? kInputs[repetition % sizeof kInputs] : repetition % kStates;
    }
  }
  *length = static_cast<uint8_t>(at - length - 1);
  *at++ = 0;  // no evaluation
  *at++ = 0;
  PORTB = 0x80;
  machine.start(code, sizeof code, inputs, rng);
  PORTB = one.opcode;
}

/// An evaluation near the largest cost that is allowed: the instruction as often as it fits.
void runWorst(uint8_t opcode, uint8_t taken) {
  uint8_t* at = code;
  *at++ = kByteCodeFormat;
  *at++ = 1;
  *at++ = 0;
  uint8_t* const length = at++;
  at = pushLong(at, randomBits());
  uint32_t cost = 5UL * instructionCost(kPushLong) + instructionCost(kDrive);
  for (;;) {
    const uint32_t step = instructionCost(opcode) + (taken == 2 ? instructionCost(kPushShort) : 0U);
    if (cost + step > kLargestCost) {
      break;
    }
    cost += step;
    if (taken == 2) {
      *at++ = kPushShort;
      *at++ = static_cast<uint8_t>(randomBits());
      *at++ = static_cast<uint8_t>(randomBits() & 0x3FU);
    }
    *at++ = opcode;
  }
  at = pushLong(at, randomBits());
  at = pushLong(at, randomBits());
  *at++ = kPushPlain;
  *at++ = 0;
  *at++ = kDrive;
  *length = static_cast<uint8_t>(at - length - 1);
  *at++ = 0;
  machine.start(code, static_cast<uint8_t>(at - code), inputs, rng);
  PORTB = 0x80;
  PORTC = static_cast<uint8_t>(machine.next(inputs, rng).duration_ms);
  PORTB = kWorstEvaluation;
}

void runEvaluation(uint8_t opcode) {
  uint8_t* at = code;
  *at++ = kByteCodeFormat;
  *at++ = 1;
  *at++ = 0;
  uint8_t* const length = at++;
  at = pushLong(at, randomBits());
  at = pushLong(at, randomBits());
  at = pushLong(at, randomBits() >> 1);
  *at++ = kPushPlain;
  *at++ = 0;
  *at++ = opcode;
  *length = static_cast<uint8_t>(at - length - 1);
  *at++ = 0;
  machine.start(code, sizeof code, inputs, rng);
  PORTB = 0x80;
  PORTC = static_cast<uint8_t>(machine.next(inputs, rng).duration_ms);
  PORTB = opcode;
}

}  // namespace

int main() {
  inputs.sensors.light_front = 1023;
  inputs.sensors.light_back = 1000;
  inputs.sensors.ir[0] = 1023;
  inputs.battery_mv = 65535;
  inputs.id = 60000;
  for (const Case& one : kCases) {
    for (uint8_t repetition = 0; repetition < kRepetitions; ++repetition) {
      inputs.time_ms = randomBits() >> (repetition % 20);
      inputs.phase_time_ms = inputs.time_ms;
      inputs.distance_um = randomBits();
      inputs.heading_turns = randomBits();
      const uint32_t before = random_state;
      run(one, repetition, false);
      random_state = before;
      run(one, repetition, true);
    }
  }
  for (uint8_t repetition = 0; repetition < kRepetitions; ++repetition) {
    runEvaluation(kDrive);
    runEvaluation(kWheelSpeeds);
    runWorst(kSqrt, 1);
    runWorst(kNormal, 2);
    runWorst(kAtan2, 2);
    runWorst(kPareto, 2);
    runWorst(kDivide, 2);
  }
  PORTB = 0x81;
  for (;;) {
  }
}
