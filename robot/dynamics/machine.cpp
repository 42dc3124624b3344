#include "robot/dynamics/machine.hpp"

#include "robot/dynamics/exponential.hpp"

namespace lab {
namespace dynamics {
namespace {

/// The position of a block: 0 is the start block, 2 p + 1 and 2 p + 2 those of phase p.
uint8_t blockPosition(const uint8_t* code, uint8_t number) {
  uint8_t at = 2;
  for (uint8_t i = 0; i < number; ++i) {
    at = static_cast<uint8_t>(at + 1U + code[at]);
  }
  return at;
}

/// `part` / `whole` as a fixed-point number, limited to the largest one; whole is below 2^16.
Fixed ratio(uint32_t part, uint32_t whole) {
  const uint32_t integer = part / whole;
  if (integer > static_cast<uint32_t>(kLargest) >> kFractionBits) {
    return kLargest;
  }
  const uint32_t rest = (part - integer * whole) << kFractionBits;
  return static_cast<Fixed>((integer << kFractionBits) + (rest + whole / 2U) / whole);
}

constexpr uint32_t kLargestCounts = 1023;

/// The one 32-bit number that has no negative becomes the smallest number.
Fixed inRange(int32_t value) { return value < kSmallest ? kSmallest : value; }

Fixed readInput(uint8_t input, const MachineInputs& in) {
  const Sensors& sensors = in.sensors;
  if (input >= kSense) {
    return inRange(in.senses[(input - kSense) % kSenses]);
  }
  if (input >= kIr && input < kIr + kIrSensors) {
    return ratio(sensors.ir[input - kIr], kLargestCounts);
  }
  switch (input) {
    case kLight:
      return ratio(static_cast<uint32_t>(sensors.light_front) + sensors.light_back,
                   2 * kLargestCounts);
    case kLightFront:
      return ratio(sensors.light_front, kLargestCounts);
    case kLightBack:
      return ratio(sensors.light_back, kLargestCounts);
    case kBattery:
      return ratio(in.battery_mv, 1000);
    case kTime:
      return ratio(in.time_ms, 1000);
    case kPhaseTime:
      return ratio(in.phase_time_ms, 1000);
    case kHeading:
      return radiansOf(in.heading_turns);
    case kDistance:
      return ratio(in.distance_um, 10000);
    case kId:
      return ratio(in.id, 1);
    default:
      return 0;
  }
}

int32_t littleEndian(const uint8_t* bytes) {
  return static_cast<int32_t>(
      static_cast<uint32_t>(bytes[0]) | static_cast<uint32_t>(bytes[1]) << 8 |
      static_cast<uint32_t>(bytes[2]) << 16 | static_cast<uint32_t>(bytes[3]) << 24);
}

Fixed uniformFixed(Fixed a, Fixed b, Rng& rng) {
  const Fixed low = a < b ? a : b;
  const uint32_t span = static_cast<uint32_t>(a < b ? b : a) - static_cast<uint32_t>(low);
  const uint32_t bits = rng.next();
  const uint64_t scaled = static_cast<uint64_t>(bits) * span + bits;  // bits * (span + 1)
  return static_cast<Fixed>(static_cast<uint32_t>(low) + static_cast<uint32_t>(scaled >> 32));
}

/// Box and Muller's transformation; it needs two numbers for each result, of which it uses one.
Fixed normalFixed(Fixed mean, Fixed deviation, Rng& rng, bool& saturated) {
  const Fixed radius = sqrtFixed(static_cast<Fixed>(2U * negativeLog(rng.next())), saturated);
  const Fixed standard = multiplyFixed(radius, cosTurns(rng.next()), saturated);
  return addFixed(mean, multiplyFixed(deviation, standard, saturated), saturated);
}

Fixed exponentialFixed(Fixed mean, Rng& rng, bool& saturated) {
  const Fixed unit = static_cast<Fixed>(negativeLog(rng.next()));
  if (mean < 0) {
    saturated = true;
    return 0;
  }
  return multiplyFixed(mean, unit, saturated);
}

/// minimum * U^(-1 / exponent).
Fixed paretoFixed(Fixed minimum, Fixed exponent, Rng& rng, bool& saturated) {
  const Fixed log2_of_inverse = static_cast<Fixed>(negativeLog2(rng.next()));
  if (exponent <= 0) {
    saturated = true;
    return minimum;
  }
  const Fixed power = divideFixed(log2_of_inverse, exponent, saturated);
  return multiplyFixed(minimum, exp2Fixed(static_cast<uint32_t>(power), saturated), saturated);
}

bool chanceFixed(Fixed probability, Rng& rng) {
  const uint32_t bits = rng.next();
  if (probability <= 0) {
    return false;
  }
  return probability >= kOne || bits < static_cast<uint32_t>(probability) << kFractionBits;
}

Fixed chooseFixed(Fixed count, Rng& rng, bool& saturated) {
  const uint32_t bits = rng.next();
  if (count < kOne) {
    saturated = true;
    return 0;
  }
  const uint32_t whole = static_cast<uint32_t>(count) >> kFractionBits;
  return static_cast<Fixed>(((static_cast<uint64_t>(bits) * whole) >> 32) << kFractionBits);
}

/// The result of an instruction that takes two numbers and leaves one.
Fixed combine(uint8_t opcode, Fixed a, Fixed b, Rng& rng, bool& saturated) {
  switch (opcode) {
    case kAdd:
      return addFixed(a, b, saturated);
    case kSubtract:
      return subtractFixed(a, b, saturated);
    case kMultiply:
      return multiplyFixed(a, b, saturated);
    case kDivide:
      return divideFixed(a, b, saturated);
    case kMin:
      return a < b ? a : b;
    case kMax:
      return a < b ? b : a;
    case kAtan2:
      return atan2Fixed(a, b);
    case kLess:
      return a < b ? 1 : 0;
    case kLessOrEqual:
      return a <= b ? 1 : 0;
    case kGreater:
      return a > b ? 1 : 0;
    case kGreaterEqual:
      return a >= b ? 1 : 0;
    case kEqual:
      return a == b ? 1 : 0;
    case kNotEqual:
      return a != b ? 1 : 0;
    case kAnd:
      return a != 0 && b != 0 ? 1 : 0;
    case kOr:
      return a != 0 || b != 0 ? 1 : 0;
    case kUniform:
      return uniformFixed(a, b, rng);
    case kNormal:
      return normalFixed(a, b, rng, saturated);
    case kPareto:
      return paretoFixed(a, b, rng, saturated);
    default:
      return 0;
  }
}

/// A number in another unit, of which the number's unit has `factor`; rounded to the nearest
/// integer.
int32_t inUnits(Fixed number, int32_t factor) {
  bool saturated = false;
  return multiplyFixed(number, factor, saturated);
}

/// The sum, limited to 1 km/s.
int32_t limitedSum(int32_t a, int32_t b) {
  constexpr int32_t kLimit = 1000000000L;
  bool saturated = false;
  const int32_t sum = addFixed(a, b, saturated);
  return sum > kLimit ? kLimit : sum < -kLimit ? -kLimit : sum;
}

constexpr int32_t kMicrometres = 10000;  ///< in a centimetre
constexpr int32_t kMilliseconds = 1000;

}  // namespace

void Machine::start(const uint8_t* code, uint8_t size, const MachineInputs& inputs, Rng& rng) {
  code_ = code;
  size_ = size;
  phase_ = 0;
  next_phase_ = 0;
  zero_holds_ = 0;
  interruptible_ = false;
  for (uint8_t i = 0; i < kStates; ++i) {
    states_[i] = 0;
  }
  arrears_ = 0;
  if (size_ == 0) {
    return;
  }
  uint8_t at = blockPosition(code_, 1);
  for (uint8_t phase = 0; phase < code_[1]; ++phase) {
    costs_[phase] = static_cast<uint8_t>((blockCost(code_ + at) >> 8) + 1U);
    at = static_cast<uint8_t>(at + 1U + code_[at]);
    at = static_cast<uint8_t>(at + 1U + code_[at]);
  }
  run(2, inputs, rng);
  count();
}

PhaseResult Machine::next(const MachineInputs& inputs, Rng& rng) {
  PhaseResult result;
  result.duration_ms = kEndless;
  if (size_ == 0) {
    return result;
  }
  phase_ = next_phase_;
  const uint8_t evaluation = blockPosition(code_, static_cast<uint8_t>(2 * phase_ + 1));
  interruption_ = static_cast<uint8_t>(evaluation + 1U + code_[evaluation]);
  interruptible_ = code_[interruption_] != 0;
  run(evaluation, inputs, rng);
  next_phase_ = phaseNumber(stack_[3]);

  const int32_t first = inUnits(stack_[0], kMicrometres);
  if (wheel_speeds_) {
    result.left_um_s = first;
    result.right_um_s = inUnits(stack_[1], kMicrometres);
  } else {
    const int32_t half_turn = inUnits(stack_[1], inputs.half_wheel_base_um);
    result.left_um_s = limitedSum(first, -half_turn);
    result.right_um_s = limitedSum(first, half_turn);
  }

  const Fixed hold = stack_[2];
  if (hold == kLargest && !saturated_) {
    arrears_ = 0;
    count();
    return result;
  }
  result.duration_ms = hold <= 0 ? 0 : static_cast<uint32_t>(inUnits(hold, kMilliseconds));
  if (hold < 0 || result.duration_ms > kLongestHoldMs) {
    result.duration_ms = hold < 0 ? 0 : kLongestHoldMs;
    saturated_ = true;
  }
  if (result.duration_ms != 0) {
    zero_holds_ = 0;
  } else if (++zero_holds_ > kZeroHolds) {
    zero_holds_ = 0;
    result.duration_ms = 1;
    saturated_ = true;
  }
  if (lengthen(result.duration_ms)) {
    saturated_ = true;
  }
  count();
  return result;
}

// Makes the hold long enough for the computing so far.
bool Machine::lengthen(uint32_t& duration_ms) {
  arrears_ = static_cast<uint16_t>(arrears_ + costs_[phase_] + kHoldOverhead);
  uint16_t needed_ms = 0;
  if (arrears_ > kComputingInArrears) {
    const auto owed = static_cast<uint16_t>(arrears_ - kComputingInArrears);
    needed_ms = static_cast<uint16_t>((unsigned{owed} + kComputingPerMs - 1U) / kComputingPerMs);
  }
  const bool too_short = duration_ms < needed_ms;
  if (too_short) {
    duration_ms = needed_ms;
  }
  const bool pays_all = duration_ms > static_cast<uint16_t>(arrears_ / kComputingPerMs);
  arrears_ = pays_all ? 0 : static_cast<uint16_t>(arrears_ - duration_ms * kComputingPerMs);
  return too_short;
}

bool Machine::interrupted(const MachineInputs& inputs, Rng& rng) {
  if (!canBeInterrupted()) {
    return false;
  }
  run(interruption_, inputs, rng);
  const bool ends = stack_[0] != 0;
  if (ends) {
    next_phase_ = phaseNumber(stack_[1]);
  }
  count();
  return ends;
}

uint8_t Machine::phaseNumber(Fixed plain) {
  if (plain < 0 || plain >= code_[1]) {
    saturated_ = true;
    return 0;
  }
  return static_cast<uint8_t>(plain);
}

// checkByteCode() has shown that no instruction leaves the stack, the code or the state.
void Machine::run(uint8_t block, const MachineInputs& inputs, Rng& rng) {
  const uint8_t* at = code_ + block + 1;
  const uint8_t* const end = at + code_[block];
  Fixed* top = stack_;  // one above the topmost number
  bool saturated = false;
  while (at != end) {
    const uint8_t opcode = *at++;
    switch (opcode) {
      case kPushByte:
        *top++ = static_cast<int8_t>(*at++) * kOne;
        break;
      case kPushShort:
        *top++ = static_cast<int16_t>(static_cast<uint16_t>(at[0] | at[1] << 8)) * 256L;
        at += 2;
        break;
      case kPushLong:
        *top++ = inRange(littleEndian(at));
        at += 4;
        break;
      case kPushPlain:
        *top++ = *at++;
        break;
      case kPushForever:
        *top++ = kLargest;
        break;
      case kLoad:
        *top++ = states_[*at++];
        break;
      case kStore:
        states_[*at++] = *--top;
        break;
      case kRead:
        *top++ = readInput(*at++, inputs);
        break;
      case kNegate:
        top[-1] = -top[-1];
        break;
      case kAbs:
        top[-1] = top[-1] < 0 ? -top[-1] : top[-1];
        break;
      case kSign:
        top[-1] = top[-1] > 0 ? kOne : top[-1] < 0 ? -kOne : 0;
        break;
      case kSqrt:
        top[-1] = sqrtFixed(top[-1], saturated);
        break;
      case kSin:
        top[-1] = sinTurns(turnsOf(top[-1]));
        break;
      case kCos:
        top[-1] = cosTurns(turnsOf(top[-1]));
        break;
      case kNot:
        top[-1] = top[-1] == 0 ? 1 : 0;
        break;
      case kExponential:
        top[-1] = exponentialFixed(top[-1], rng, saturated);
        break;
      case kChance:
        top[-1] = chanceFixed(top[-1], rng) ? 1 : 0;
        break;
      case kChanceOf:
        *top++ = rng.next() < static_cast<uint32_t>(littleEndian(at)) ? 1 : 0;
        at += 4;
        break;
      case kChoose:
        top[-1] = chooseFixed(top[-1], rng, saturated);
        break;
      case kSelect:
        top -= 2;
        top[-1] = top[-1] != 0 ? top[0] : top[1];
        break;
      case kDrive:
        wheel_speeds_ = false;
        break;
      case kWheelSpeeds:
        wheel_speeds_ = true;
        break;
      default:
        --top;
        top[-1] = combine(opcode, top[-1], top[0], rng, saturated);
        break;
    }
  }
  saturated_ = saturated;
}

}  // namespace dynamics
}  // namespace lab
