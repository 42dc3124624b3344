// The paper's programs on the machine: their draws, to the bit, and their laws.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "robot/dynamics/machine.hpp"
#include "tests/robot/programs.hpp"

namespace lab::dynamics {
namespace {

/// A program on a machine with its own draws.
class Running {
 public:
  Running(const language::ProgramText& text, uint64_t seed) : code_(codeOf(text)), rng_(seed) {
    machine_.start(code_.data(), static_cast<uint8_t>(code_.size()), inputs_, rng_);
  }

  PhaseResult next() { return machine_.next(inputs_, rng_); }
  const Machine& machine() const { return machine_; }
  const Rng& rng() const { return rng_; }

 private:
  std::vector<uint8_t> code_;
  Rng rng_;
  MachineInputs inputs_;
  Machine machine_;
};

language::ProgramText abp2b() { return abpText("3 cm/s", "0.5 s", "3 rad/s"); }
language::ProgramText noisyAbp() { return wheelNoiseText("1 cm/s", "10 cm/s", "0.1 s"); }
language::ProgramText rtp() { return rtpText("5 cm/s", "3 1/s", "0.5 s"); }

struct Row {
  int32_t left, right;
  uint32_t ms;
};

void expectHolds(const language::ProgramText& text, const std::vector<Row>& expected) {
  Running dut(text, 42);
  for (const Row& row : expected) {
    const PhaseResult hold = dut.next();
    EXPECT_EQ(hold.left_um_s, row.left);
    EXPECT_EQ(hold.right_um_s, row.right);
    EXPECT_EQ(hold.duration_ms, row.ms);
  }
}

// Every robot and every host draws exactly these numbers from seed 42.
TEST(Program, DrawsThePinnedSequences) {
  expectHolds(abp2b(), {{4002, 55998, 500},
                        {50181, 9819, 500},
                        {56997, 3003, 500},
                        {68224, -8224, 500},
                        {-31773, 91773, 500},
                        {-66490, 126490, 500}});
  expectHolds(noisyAbp(), {{33109, -7939, 100},
                           {-13997, -23976, 100},
                           {64910, 95769, 100},
                           {109286, 43897, 100},
                           {35393, 80763, 100},
                           {26309, -61784, 100}});
  expectHolds(rtp(), {{50000, 50000, 162},
                      {42268, -42268, 500},
                      {50000, 50000, 323},
                      {80055, -80055, 500},
                      {50000, 50000, 85},
                      {-202088, 202088, 500}});
}

TEST(Program, AbpHasConstantSpeedAndATurningRateUniformWithinEta) {
  constexpr int kDraws = 1000000;
  Running dut(abp2b(), 1);
  double sum = 0;
  double sum2 = 0;
  for (int i = 0; i < kDraws; ++i) {
    const PhaseResult hold = dut.next();
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
  Running dut(noisyAbp(), 2);
  double left = 0;
  double left2 = 0;
  double both = 0;
  double squares = 0;
  for (int i = 0; i < kDraws; ++i) {
    const PhaseResult hold = dut.next();
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
  Running dut(rtp(), 3);
  double angle = 0;
  double angle2 = 0;
  double run_ms = 0;
  for (int i = 0; i < kPairs; ++i) {
    const PhaseResult run = dut.next();
    ASSERT_EQ(dut.machine().phase(), 0);
    ASSERT_EQ(run.left_um_s, 50000);
    ASSERT_EQ(run.right_um_s, 50000);
    run_ms += run.duration_ms;
    const PhaseResult tumble = dut.next();
    ASSERT_EQ(dut.machine().phase(), 1);
    ASSERT_LE(std::abs(tumble.left_um_s + tumble.right_um_s), 1);
    ASSERT_EQ(tumble.duration_ms, 500U);
    const double turn = 2 * tumble.right_um_s / 75000.0 * 0.5;
    ASSERT_LE(std::abs(turn), 3.14163);
    angle += turn;
    angle2 += turn * turn;
  }
  const double pi2 = 9.8696044;
  EXPECT_LT(std::abs(run_ms / kPairs - 333.333) / (333.333 / std::sqrt(kPairs)), 4);
  EXPECT_LT(std::abs(angle / kPairs) / std::sqrt(pi2 / 3 / kPairs), 4);
  EXPECT_LT(std::abs(angle2 / kPairs - pi2 / 3) / (pi2 * std::sqrt(4 / 45.0 / kPairs)), 4);
}

TEST(Program, ConstantWheelsDrawNothingAndNeverEnd) {
  Running dut(wheelsText(-20000, 40000), 5);
  const uint32_t digest = dut.rng().digest();
  const PhaseResult hold = dut.next();
  EXPECT_EQ(hold.left_um_s, -20000);
  EXPECT_EQ(hold.right_um_s, 40000);
  EXPECT_EQ(hold.duration_ms, kEndless);
  EXPECT_EQ(dut.rng().digest(), digest);
}

}  // namespace
}  // namespace lab::dynamics
