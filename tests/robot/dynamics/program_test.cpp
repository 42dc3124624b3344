#include "robot/dynamics/program.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "robot/dynamics/motor.hpp"

namespace lab::dynamics {
namespace {

ProgramParams abp2b() {
  ProgramParams p;
  p.kind = kAbp;
  p.speed_um_s = 30000;
  p.amplitude_um_s = 112500;
  p.hold_ms = 500;
  return p;
}

ProgramParams bp(ProgramKind kind, int32_t va, int32_t V) {
  ProgramParams p;
  p.kind = kind;
  p.speed_um_s = va;
  p.amplitude_um_s = V;
  p.hold_ms = 100;
  return p;
}

ProgramParams rtp() {
  ProgramParams p;
  p.kind = kRtp;
  p.speed_um_s = 50000;
  p.mean_run_us = 333333;
  p.tumble_ms = 500;
  p.tumble_amplitude_um_s = 235619;
  return p;
}

struct Row {
  int32_t left, right;
  uint32_t ms;
};

void expectHolds(const ProgramParams& params, const std::vector<Row>& expected) {
  Rng rng(42);
  Program dut;
  dut.start(params);
  for (const Row& row : expected) {
    const Hold hold = dut.next(rng);
    EXPECT_EQ(hold.left_um_s, row.left);
    EXPECT_EQ(hold.right_um_s, row.right);
    EXPECT_EQ(hold.duration_ms, row.ms);
  }
}

// The robot must draw exactly these numbers from seed 42.
TEST(Program, DrawsThePinnedSequences) {
  expectHolds(abp2b(), {{4002, 55998, 500},
                        {50181, 9819, 500},
                        {56997, 3003, 500},
                        {68224, -8224, 500},
                        {-31774, 91774, 500},
                        {-66490, 126490, 500}});
  expectHolds(bp(kNoisyAbp, 10000, 100000), {{33109, -7939, 100},
                                             {-13997, -23977, 100},
                                             {64910, 95769, 100},
                                             {109287, 43897, 100},
                                             {35393, 80763, 100},
                                             {26309, -61784, 100}});
  expectHolds(rtp(), {{50000, 50000, 162},
                      {42267, -42267, 500},
                      {50000, 50000, 323},
                      {80055, -80055, 500},
                      {50000, 50000, 85},
                      {-202087, 202087, 500}});
}

TEST(Program, AbpHasConstantSpeedAndATurningRateUniformWithinEta) {
  constexpr int kDraws = 1000000;
  Rng rng(1);
  Program dut;
  dut.start(abp2b());
  double sum = 0;
  double sum2 = 0;
  for (int i = 0; i < kDraws; ++i) {
    const Hold hold = dut.next(rng);
    ASSERT_EQ(hold.left_um_s + hold.right_um_s, 60000);
    const double zeta = (hold.right_um_s - hold.left_um_s) / 75000.0;  // theta' = (v_r - v_l) / d
    ASSERT_LE(std::abs(zeta), 3.0);
    sum += zeta;
    sum2 += zeta * zeta;
  }
  EXPECT_LT(std::abs(sum / kDraws) / std::sqrt(3.0 / kDraws), 4);
  EXPECT_LT(std::abs(sum2 / kDraws - 3) / std::sqrt(81.0 * 4 / 45 / kDraws), 4);
}

TEST(Program, WheelNoiseDrawsTheWheelsIndependently) {
  constexpr int kDraws = 1000000;
  Rng rng(2);
  Program dut;
  dut.start(bp(kNoisyAbp, 10000, 100000));
  double left = 0;
  double left2 = 0;
  double both = 0;
  double squares = 0;
  for (int i = 0; i < kDraws; ++i) {
    const Hold hold = dut.next(rng);
    const double l = (hold.left_um_s - 10000) / 100000.0;
    const double r = (hold.right_um_s - 10000) / 100000.0;
    ASSERT_LE(std::abs(l), 1);
    ASSERT_LE(std::abs(r), 1);
    left += l;
    left2 += l * l;
    both += l * r;
    squares += (l * l - 1 / 3.0) * (r * r - 1 / 3.0);
  }
  EXPECT_LT(std::abs(left / kDraws) / std::sqrt(1 / 3.0 / kDraws), 4);
  EXPECT_LT(std::abs(left2 / kDraws - 1 / 3.0) / std::sqrt(4 / 45.0 / kDraws), 4);
  EXPECT_LT(std::abs(both / kDraws) / (1 / 3.0 / std::sqrt(kDraws)), 4);
  EXPECT_LT(std::abs(squares / kDraws) / (4 / 45.0 / std::sqrt(kDraws)), 4);
}

TEST(Program, RtpAlternatesRunsAndTumblesAndBeginsWithARun) {
  constexpr int kPairs = 1000000;
  Rng rng(3);
  Program dut;
  dut.start(rtp());
  double angle = 0;
  double angle2 = 0;
  double run_ms = 0;
  for (int i = 0; i < kPairs; ++i) {
    const Hold run = dut.next(rng);
    ASSERT_FALSE(run.tumble);
    ASSERT_EQ(run.left_um_s, 50000);
    ASSERT_EQ(run.right_um_s, 50000);
    run_ms += run.duration_ms;
    const Hold tumble = dut.next(rng);
    ASSERT_TRUE(tumble.tumble);
    ASSERT_EQ(tumble.left_um_s, -tumble.right_um_s);
    ASSERT_EQ(tumble.duration_ms, 500U);
    const double turn = 2 * tumble.right_um_s / 75000.0 * 0.5;
    ASSERT_LE(std::abs(turn), 3.14160);
    angle += turn;
    angle2 += turn * turn;
  }
  const double pi2 = 9.8696044;
  EXPECT_LT(std::abs(run_ms / kPairs - 333.333) / (333.333 / std::sqrt(kPairs)), 4);
  EXPECT_LT(std::abs(angle / kPairs) / std::sqrt(pi2 / 3 / kPairs), 4);
  EXPECT_LT(std::abs(angle2 / kPairs - pi2 / 3) / (pi2 * std::sqrt(4 / 45.0 / kPairs)), 4);
}

TEST(Program, StartingAgainBeginsWithARun) {
  Rng rng(4);
  Program dut;
  dut.start(rtp());
  (void)dut.next(rng);
  dut.start(rtp());
  EXPECT_FALSE(dut.next(rng).tumble);
}

TEST(Program, StandingAndConstantWheelsDrawNothingAndNeverEnd) {
  Rng rng(5);
  const uint32_t state = rng.stateWord(0);
  Program dut;
  dut.start(ProgramParams());
  Hold hold = dut.next(rng);
  EXPECT_EQ(hold.left_um_s, 0);
  EXPECT_EQ(hold.right_um_s, 0);
  EXPECT_EQ(hold.duration_ms, kForever);
  ProgramParams wheels;
  wheels.kind = kWheels;
  wheels.left_um_s = -20000;
  wheels.right_um_s = 40000;
  dut.start(wheels);
  hold = dut.next(rng);
  EXPECT_EQ(hold.left_um_s, -20000);
  EXPECT_EQ(hold.right_um_s, 40000);
  EXPECT_EQ(hold.duration_ms, kForever);
  EXPECT_EQ(rng.stateWord(0), state);
}

TEST(Program, InvalidTimesLastAtLeastOneMillisecond) {
  Rng rng(6);
  Program dut;
  ProgramParams params = abp2b();
  params.hold_ms = 0;
  dut.start(params);
  EXPECT_EQ(dut.next(rng).duration_ms, 1U);
  params = rtp();
  params.tumble_ms = 0;
  dut.start(params);
  (void)dut.next(rng);
  EXPECT_EQ(dut.next(rng).duration_ms, 1U);
}

// No settings are valid that contain these numbers, but bytes may; see the sanitizers.
TEST(Program, EndsEveryDrawWhateverItsParameters) {
  const int32_t extremes[] = {0, 1, -1, INT32_MAX, INT32_MIN};
  Rng rng(1);
  for (const int32_t speed : extremes) {
    for (const int32_t amplitude : extremes) {
      for (uint8_t kind = 0; kind < kProgramKinds; ++kind) {
        ProgramParams params;
        params.kind = static_cast<ProgramKind>(kind);
        params.speed_um_s = speed;
        params.amplitude_um_s = amplitude;
        params.tumble_amplitude_um_s = amplitude;
        params.mean_run_us = 0xFFFFFFFFU;
        Program dut;
        dut.start(params);
        uint64_t time = 0;
        for (int draw = 0; draw < 4; ++draw) {
          const Hold hold = dut.next(rng);
          bool saturated = false;
          time += hold.duration_ms;
          static_cast<void>(clampWheel(hold.left_um_s, speed, saturated));
          static_cast<void>(dutyForSpeed(hold.right_um_s, speed));
        }
        EXPECT_GT(time, 0U);
      }
    }
  }
}

}  // namespace
}  // namespace lab::dynamics
