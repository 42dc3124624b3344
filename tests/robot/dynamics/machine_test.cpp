#include "robot/dynamics/machine.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>
#include <vector>

namespace lab::dynamics {
namespace {

using Bytes = std::vector<uint8_t>;

Bytes block(Bytes instructions) {
  instructions.insert(instructions.begin(), static_cast<uint8_t>(instructions.size()));
  return instructions;
}

Bytes joined(const std::vector<Bytes>& parts) {
  Bytes all;
  for (const Bytes& part : parts) {
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

ByteCodeCheck check(const Bytes& code) {
  return checkByteCode(code.data(), static_cast<uint16_t>(code.size()));
}

/// A program of one phase: `speed` leaves the first speed, the turn is 0, the hold 1 s.
Bytes onePhase(const Bytes& speed, const Bytes& interruption = {}) {
  return joined({{kByteCodeFormat, 1, 0},
                 block(joined({speed, {kPushByte, 0, kPushByte, 1, kPushPlain, 0, kDrive}})),
                 block(interruption)});
}

TEST(ByteCode, AcceptsAProgramAndNamesEveryFault) {
  EXPECT_EQ(check(onePhase({kPushByte, 5})).fault, kValidByteCode);
  EXPECT_EQ(check({}).fault, kTooLong);
  EXPECT_EQ(check(Bytes(kLargestProgram + 1, kByteCodeFormat)).fault, kTooLong);
  EXPECT_EQ(check({0x50, 1, 0}).fault, kOtherFormat);
  EXPECT_EQ(check({kByteCodeFormat, 0, 0}).fault, kBadPhases);
  EXPECT_EQ(check({kByteCodeFormat, 9, 0}).fault, kBadPhases);
  EXPECT_EQ(check({kByteCodeFormat, 1, 0}).fault, kBadBlock);
  EXPECT_EQ(check({kByteCodeFormat, 1, 9, kPushByte}).fault, kBadBlock);
  EXPECT_EQ(check(joined({onePhase({kPushByte, 5}), {0}})).fault, kBadBlock);
  EXPECT_EQ(check(onePhase({0})).fault, kBadOpcode);
  EXPECT_EQ(check(onePhase({kPushByte, 5, kDrive})).fault, kStackUnderflow);
  EXPECT_EQ(check(onePhase({kLoad, 8})).fault, kBadOperand);
  EXPECT_EQ(check(onePhase({kRead, 15})).fault, kBadOperand);
  EXPECT_EQ(check(onePhase({kAdd})).fault, kStackUnderflow);
  EXPECT_EQ(check(onePhase(Bytes(13, kPushForever))).fault, kStackOverflow);
  EXPECT_EQ(check(onePhase({kPushByte, 1, kPushByte, 1})).fault, kBadResult);
  EXPECT_EQ(check(onePhase({kPushByte, 5}, {kPushPlain, 1})).fault, kBadResult);
  Bytes slow{kPushByte, 5};
  for (int i = 0; i < 12; ++i) {
    slow.insert(slow.end(), {kPushByte, 1, kNormal});
  }
  EXPECT_EQ(check(onePhase(slow)).fault, kTooSlow);
  const ByteCodeCheck bad = check(onePhase({kPushByte, 5, kLoad, 8, kAdd}));
  EXPECT_EQ(bad.position, 6);
}

TEST(ByteCode, AnyBytesAreRejectedOrExecutedWithinTheBound) {
  std::mt19937 rng(5);
  const Bytes valid = joined(
      {{kByteCodeFormat, 2},
       block({kPushByte, 1, kStore, 0}),
       block({kLoad, 0, kRead, kSense, kUniform, kPushByte, 0, kPushShort, 20, 0, kPushPlain, 1,
              kDrive}),
       block({kRead, kLight, kPushShort, 9, 0, kGreater, kPushPlain, 0}),
       block({kPushByte, 1, kPushByte, 2, kPushByte, 1, kExponential, kPushPlain, 0, kWheelSpeeds}),
       block({})});
  ASSERT_EQ(check(valid).fault, kValidByteCode);
  int executed = 0;
  const char* many = std::getenv("LAB_BYTE_STRINGS");
  const int strings = many == nullptr ? 300000 : std::atoi(many);
  for (int i = 0; i < strings; ++i) {
    Bytes code = valid;
    if (i % 4 == 0) {
      code.resize(rng() % 200);
      for (uint8_t& byte : code) {
        byte = static_cast<uint8_t>(rng());
      }
    } else {
      for (unsigned change = 0; change <= rng() % 4; ++change) {
        const std::size_t at = rng() % code.size();
        // Mostly opcodes, so that many mutants stay valid.
        code[at] = static_cast<uint8_t>(rng() % 3 == 0 ? rng() : rng() % 70);
      }
    }
    if (check(code).fault != kValidByteCode) {
      continue;
    }
    ++executed;
    Rng draws(static_cast<uint64_t>(i));
    MachineInputs inputs;
    for (Fixed& sense : inputs.senses) {
      sense = static_cast<Fixed>(draws.next());
    }
    inputs.sensors.light_front = static_cast<uint16_t>(draws.next());
    inputs.time_ms = draws.next();
    inputs.distance_um = draws.next();
    Machine machine;
    machine.start(code.data(), static_cast<uint8_t>(code.size()), inputs, draws);
    uint64_t duration_ms = 0;
    for (int step = 0; step < 20; ++step) {
      const PhaseResult result = machine.next(inputs, draws);
      duration_ms += result.duration_ms;
      ASSERT_TRUE(result.duration_ms <= kLongestHoldMs || result.duration_ms == kEndless);
      ASSERT_LT(machine.phase(), code[1]);
      machine.interrupted(inputs, draws);
    }
    ASSERT_GE(duration_ms, 2U);  // at least one millisecond in every nine holds
  }
  EXPECT_GT(executed, strings / 50);
}

/// The number that `instructions` leave.
double evaluated(const Bytes& instructions, const MachineInputs& inputs = MachineInputs()) {
  const Bytes code = joined({{kByteCodeFormat, 1},
                             block({}),
                             block(joined({instructions,
                                           {kStore, 0, kPushByte, 0, kPushByte, 0, kPushByte, 1,
                                            kPushPlain, 0, kDrive}})),
                             block({})});
  EXPECT_EQ(check(code).fault, kValidByteCode);
  Machine machine;
  Rng rng(1);
  machine.start(code.data(), static_cast<uint8_t>(code.size()), inputs, rng);
  machine.next(inputs, rng);
  return machine.state(0) / static_cast<double>(kOne);
}

TEST(Machine, EvaluatesEveryInstruction) {
  const Bytes seven{kPushByte, 7};
  const Bytes minus_two{kPushByte, 0xFE};
  const auto pair = [&](uint8_t opcode) { return joined({seven, minus_two, {opcode}}); };
  const auto truth = [&](Bytes condition) {
    return joined({std::move(condition), {kPushByte, 1, kPushByte, 0, kSelect}});
  };
  EXPECT_EQ(evaluated(pair(kAdd)), 5);
  EXPECT_EQ(evaluated(pair(kSubtract)), 9);
  EXPECT_EQ(evaluated(pair(kMultiply)), -14);
  EXPECT_EQ(evaluated(pair(kDivide)), -3.5);
  EXPECT_EQ(evaluated(pair(kMin)), -2);
  EXPECT_EQ(evaluated(pair(kMax)), 7);
  EXPECT_NEAR(evaluated(pair(kAtan2)), std::atan2(7, -2), 4e-5);
  EXPECT_EQ(evaluated(joined({minus_two, {kNegate}})), 2);
  EXPECT_EQ(evaluated(joined({minus_two, {kAbs}})), 2);
  EXPECT_EQ(evaluated(joined({minus_two, {kSign}})), -1);
  EXPECT_NEAR(evaluated(joined({seven, {kSqrt}})), std::sqrt(7), 2e-5);
  EXPECT_NEAR(evaluated(joined({seven, {kSin}})), std::sin(7), 3e-5);
  EXPECT_NEAR(evaluated(joined({seven, {kCos}})), std::cos(7), 3e-5);
  EXPECT_EQ(evaluated(truth(pair(kLess))), 0);
  EXPECT_EQ(evaluated(truth(pair(kLessOrEqual))), 0);
  EXPECT_EQ(evaluated(truth(pair(kGreater))), 1);
  EXPECT_EQ(evaluated(truth(pair(kGreaterEqual))), 1);
  EXPECT_EQ(evaluated(truth(pair(kEqual))), 0);
  EXPECT_EQ(evaluated(truth(pair(kNotEqual))), 1);
  EXPECT_EQ(evaluated(truth({kPushPlain, 1, kPushPlain, 0, kAnd})), 0);
  EXPECT_EQ(evaluated(truth({kPushPlain, 1, kPushPlain, 0, kOr})), 1);
  EXPECT_EQ(evaluated(truth({kPushPlain, 1, kNot})), 0);
  EXPECT_EQ(evaluated({kPushShort, 0x80, 0xFF}), -0.5);
  EXPECT_EQ(evaluated({kPushLong, 1, 0, 0, 0}), 1 / 65536.0);
  EXPECT_EQ(evaluated({kPushLong, 0, 0, 0, 0x80, kNegate}), kLargest / 65536.0);
}

TEST(Machine, ReadsItsInputsInTheUnitsOfPrograms) {
  MachineInputs inputs;
  inputs.sensors.light_front = 1023;
  inputs.sensors.light_back = 0;
  inputs.sensors.ir[5] = 1023;
  inputs.battery_mv = 3700;
  inputs.id = 12;
  inputs.time_ms = 2500;
  inputs.phase_time_ms = 500;
  inputs.heading_turns = 0x40000000U;
  inputs.distance_um = 123400;
  inputs.senses[7] = -3 * kOne;
  const auto read = [&](uint8_t input) { return evaluated({kRead, input}, inputs); };
  EXPECT_EQ(read(kLight), 0.5);
  EXPECT_EQ(read(kLightFront), 1);
  EXPECT_EQ(read(kLightBack), 0);
  EXPECT_EQ(read(kIr + 5), 1);
  EXPECT_NEAR(read(kBattery), 3.7, 1e-5);
  EXPECT_EQ(read(kTime), 2.5);
  EXPECT_EQ(read(kPhaseTime), 0.5);
  EXPECT_NEAR(read(kHeading), std::acos(0), 1e-5);
  EXPECT_NEAR(read(kDistance), 12.34, 1e-5);
  EXPECT_EQ(read(kId), 12);
  EXPECT_EQ(read(kSense + 7), -3);
}

/// Draws of a program of one phase whose forward speed is drawn.
struct Moments {
  double mean = 0;
  double variance = 0;
};

Moments moments(const Bytes& draw, int draws) {
  const Bytes code = joined(
      {{kByteCodeFormat, 1},
       block({}),
       block(joined(
           {draw, {kStore, 0, kPushByte, 0, kPushByte, 0, kPushByte, 1, kPushPlain, 0, kDrive}})),
       block({})});
  EXPECT_EQ(check(code).fault, kValidByteCode);
  Machine machine;
  Rng rng(7);
  const MachineInputs inputs;
  machine.start(code.data(), static_cast<uint8_t>(code.size()), inputs, rng);
  double sum = 0;
  double squares = 0;
  for (int i = 0; i < draws; ++i) {
    machine.next(inputs, rng);
    const double x = machine.state(0) / static_cast<double>(kOne);
    sum += x;
    squares += x * x;
  }
  EXPECT_EQ(machine.saturationCount(), 0U);
  const double mean = sum / draws;
  return {mean, squares / draws - mean * mean};
}

TEST(Machine, DrawsHaveTheirMeansAndVariances) {
  constexpr int kDraws = 1000000;
  const auto expectMoments = [&](const Moments& got, double mean, double variance,
                                 double fourth_central) {
    EXPECT_LT(std::abs(got.mean - mean) / std::sqrt(variance / kDraws), 4);
    EXPECT_LT(std::abs(got.variance - variance) /
                  std::sqrt((fourth_central - variance * variance) / kDraws),
              4);
  };
  // Uniform on [-2, 7]: width w = 9, variance w^2 / 12, fourth central moment w^4 / 80.
  expectMoments(moments({kPushByte, 7, kPushByte, 0xFE, kUniform}, kDraws), 2.5, 6.75,
                std::pow(9, 4) / 80);
  expectMoments(moments({kPushByte, 3, kPushByte, 2, kNormal}, kDraws), 3, 4, 48);
  expectMoments(moments({kPushByte, 2, kExponential}, kDraws), 2, 4, 9 * 16);
  // Pareto with minimum 1 and exponent a = 9: mean a / (a - 1), raw moments a / (a - k).
  const double mean = 9.0 / 8;
  const double second = 9.0 / 7;
  const double variance = second - mean * mean;
  const double fourth =
      9.0 / 5 - 4 * mean * 9.0 / 6 + 6 * mean * mean * second - 3 * std::pow(mean, 4);
  expectMoments(moments({kPushByte, 1, kPushByte, 9, kPareto}, kDraws), mean, variance, fourth);
  // choose(5): 0 to 4.
  expectMoments(moments({kPushByte, 5, kChoose}, kDraws), 2, 2, 6.8);
  const auto chance = [&](const Bytes& condition, double p) {
    const Moments got = moments(joined({condition, {kPushByte, 1, kPushByte, 0, kSelect}}), kDraws);
    EXPECT_LT(std::abs(got.mean - p) / std::sqrt(p * (1 - p) / kDraws), 4);
  };
  chance({kPushShort, 64, 0, kChance}, 0.25);
  chance({kChanceOf, 0, 0, 0, 0x10}, 1 / 16.0);
}

TEST(Machine, ForwardAndTurnBecomeWheelSpeeds) {
  const Bytes code =
      joined({{kByteCodeFormat, 1, 0},
              block({kPushByte, 5, kPushByte, 2, kPushShort, 0x80, 0, kPushPlain, 0, kDrive}),
              {0}});
  ASSERT_EQ(check(code).fault, kValidByteCode);
  Machine machine;
  Rng rng(1);
  const MachineInputs inputs;
  machine.start(code.data(), static_cast<uint8_t>(code.size()), inputs, rng);
  const PhaseResult result = machine.next(inputs, rng);
  // 5 cm/s and 2 rad/s with 7.5 cm between the wheels.
  EXPECT_EQ(result.left_um_s, 50000 - 75000);
  EXPECT_EQ(result.right_um_s, 50000 + 75000);
  EXPECT_EQ(result.duration_ms, 500U);
}

TEST(Machine, ZeroHoldsAreLimited) {
  const Bytes code =
      joined({{kByteCodeFormat, 1, 0},
              block({kPushByte, 5, kPushByte, 0, kPushByte, 0, kPushPlain, 0, kDrive}),
              {0}});
  Machine machine;
  Rng rng(1);
  const MachineInputs inputs;
  machine.start(code.data(), static_cast<uint8_t>(code.size()), inputs, rng);
  for (int i = 0; i < kZeroHolds; ++i) {
    EXPECT_EQ(machine.next(inputs, rng).duration_ms, 0U);
  }
  EXPECT_EQ(machine.next(inputs, rng).duration_ms, 1U);
  EXPECT_EQ(machine.saturationCount(), 1U);
}

TEST(Machine, HoldsAreLongEnoughForTheirEvaluations) {
  // Two normal draws take 27 000 cycles, 3.4 ms, for each hold of 1 ms.
  const Bytes draw{kPushByte, 5, kPushByte, 1, kNormal};
  const Bytes code =
      joined({{kByteCodeFormat, 1, 0},
              block(joined({draw, draw, {kPushShort, 0, 0, kPushPlain, 0, kWheelSpeeds}})),
              {0}});
  ASSERT_EQ(check(code).fault, kValidByteCode);
  Machine machine;
  Rng rng(1);
  const MachineInputs inputs;
  machine.start(code.data(), static_cast<uint8_t>(code.size()), inputs, rng);
  uint64_t time_ms = 0;
  constexpr int kHolds = 10000;
  for (int i = 0; i < kHolds; ++i) {
    const uint32_t ms = machine.next(inputs, rng).duration_ms;
    EXPECT_LE(ms, 12U);
    time_ms += ms;
  }
  const double computing_ms = kHolds * (blockCost(code.data() + 3) + 256.0 * kHoldOverhead) / 8000;
  EXPECT_NEAR(computing_ms / static_cast<double>(time_ms), 0.5, 0.03);
  EXPECT_GT(machine.saturationCount(), 9000U);
}

TEST(Machine, AConditionEndsAHoldAndChoosesThePhase) {
  const Bytes drive{kPushByte, 5, kPushByte, 0, kPushForever, kPushPlain, 0, kDrive};
  const Bytes back{kPushByte, 0xFB, kPushByte, 0, kPushByte, 1, kPushPlain, 0, kDrive};
  const Bytes code = joined({{kByteCodeFormat, 2, 0},
                             block(drive),
                             block({kRead, kIr, kPushShort, 0x80, 0, kGreater, kPushPlain, 1}),
                             block(back),
                             {0}});
  ASSERT_EQ(check(code).fault, kValidByteCode);
  Machine machine;
  Rng rng(1);
  MachineInputs inputs;
  machine.start(code.data(), static_cast<uint8_t>(code.size()), inputs, rng);
  EXPECT_EQ(machine.next(inputs, rng).duration_ms, kEndless);
  EXPECT_FALSE(machine.interrupted(inputs, rng));
  inputs.sensors.ir[0] = 600;
  EXPECT_TRUE(machine.interrupted(inputs, rng));
  EXPECT_EQ(machine.next(inputs, rng).left_um_s, -50000);
  EXPECT_EQ(machine.phase(), 1);
  EXPECT_FALSE(machine.canBeInterrupted());
}

TEST(Machine, WithoutProgramTheWheelsStand) {
  Machine machine;
  Rng rng(1);
  const MachineInputs inputs;
  machine.start(nullptr, 0, inputs, rng);
  const PhaseResult result = machine.next(inputs, rng);
  EXPECT_EQ(result.left_um_s, 0);
  EXPECT_EQ(result.duration_ms, kEndless);
  EXPECT_FALSE(machine.interrupted(inputs, rng));
}

}  // namespace
}  // namespace lab::dynamics
