#include "robot/dynamics/robot_program.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace lab::dynamics::params_from_physics_test {
namespace {

using ::testing::HasSubstr;

RobotProgram abp(double v, double epsilon, double eta) {
  RobotProgram p;
  p.kind = kAbp;
  p.v = v;
  p.epsilon = epsilon;
  p.eta = eta;
  return p;
}

RobotProgram wheelNoise(ProgramKind kind, double va, double V, double epsilon) {
  RobotProgram p;
  p.kind = kind;
  p.va = va;
  p.V = V;
  p.epsilon = epsilon;
  return p;
}

RobotProgram rtp(double v, double gamma, double tau_t) {
  RobotProgram p;
  p.kind = kRtp;
  p.v = v;
  p.gamma = gamma;
  p.tau_t = tau_t;
  return p;
}

TEST(ParamsFromPhysics, ConvertsThePapersPrograms) {
  const ParamsResult abp_2b = toProgramParams(abp(0.03, 0.5, 3));
  ASSERT_TRUE(abp_2b.ok) << abp_2b.reason;
  EXPECT_EQ(abp_2b.params.kind, kAbp);
  EXPECT_EQ(abp_2b.params.speed_um_s, 30000);
  EXPECT_EQ(abp_2b.params.amplitude_um_s, 112500);
  EXPECT_EQ(abp_2b.params.hold_ms, 500U);

  const ParamsResult noisy_3b = toProgramParams(wheelNoise(kNoisyAbp, 0.01, 0.10, 0.1));
  ASSERT_TRUE(noisy_3b.ok) << noisy_3b.reason;
  EXPECT_EQ(noisy_3b.params.speed_um_s, 10000);
  EXPECT_EQ(noisy_3b.params.amplitude_um_s, 100000);

  const ParamsResult rtp_4b = toProgramParams(rtp(0.05, 3, 0.5));
  ASSERT_TRUE(rtp_4b.ok) << rtp_4b.reason;
  EXPECT_EQ(rtp_4b.params.mean_run_us, 333333U);
  EXPECT_EQ(rtp_4b.params.tumble_ms, 500U);
  EXPECT_EQ(rtp_4b.params.tumble_amplitude_um_s, 235619);
}

TEST(ParamsFromPhysics, GoesThereAndBack) {
  const RobotProgram p = toRobotProgram(toProgramParams(rtp(0.05, 4, 0.5004)).params);
  EXPECT_EQ(p.kind, kRtp);
  EXPECT_DOUBLE_EQ(p.v, 0.05);
  EXPECT_DOUBLE_EQ(p.gamma, 4);
  EXPECT_DOUBLE_EQ(p.tau_t, 0.5) << "what is executed, not what was asked for";
  const RobotProgram q = toRobotProgram(toProgramParams(abp(0.03, 0.5, 3)).params);
  EXPECT_DOUBLE_EQ(q.eta, 3);
  const RobotProgram b = toRobotProgram(toProgramParams(wheelNoise(kBp, 0, 0.07, 0.2)).params);
  EXPECT_DOUBLE_EQ(b.V, 0.07);
  EXPECT_DOUBLE_EQ(b.va, 0);
}

TEST(ParamsFromPhysics, RefusesWhatTheWheelsCannotDo) {
  const ParamsResult fast_turn = toProgramParams(abp(0.03, 0.5, 6.5));
  EXPECT_FALSE(fast_turn.ok);
  EXPECT_THAT(fast_turn.reason, HasSubstr("|v| + eta d / 2"));
  EXPECT_THAT(fast_turn.reason, HasSubstr("27.38 cm/s"));
  EXPECT_THAT(fast_turn.reason, HasSubstr("27 cm/s"));
  EXPECT_TRUE(toProgramParams(abp(0.03, 0.5, 6.4)).ok) << "a limit met exactly is allowed";

  const ParamsResult backward = toProgramParams(abp(-0.05, 0.5, 6));
  EXPECT_FALSE(backward.ok) << "driving backward needs as much";

  const ParamsResult noise = toProgramParams(wheelNoise(kNoisyAbp, -0.02, 0.26, 0.1));
  EXPECT_FALSE(noise.ok);
  EXPECT_THAT(noise.reason, HasSubstr("V + |va|"));
  EXPECT_THAT(noise.reason, HasSubstr("28 cm/s"));

  const ParamsResult tumble = toProgramParams(rtp(0.05, 3, 0.43));
  EXPECT_FALSE(tumble.ok);
  EXPECT_THAT(tumble.reason, HasSubstr("tau_t"));
  EXPECT_THAT(tumble.reason, HasSubstr("at least 0.437 s"));
  EXPECT_TRUE(toProgramParams(rtp(0.05, 3, 0.437)).ok);

  RobotProgram wheels;
  wheels.kind = kWheels;
  wheels.wheel_right = -0.3;
  EXPECT_THAT(toProgramParams(wheels).reason, HasSubstr("right wheel"));
}

TEST(ParamsFromPhysics, RefusesTimesBelowAMillisecond) {
  EXPECT_THAT(toProgramParams(abp(0.03, 0.0009, 3)).reason, HasSubstr("epsilon"));
  EXPECT_THAT(toProgramParams(abp(0.03, 0, 3)).reason, HasSubstr("epsilon"));
  EXPECT_THAT(toProgramParams(abp(0.03, -0.5, 3)).reason, HasSubstr("epsilon"));
  EXPECT_TRUE(toProgramParams(abp(0.03, 0.001, 3)).ok);
  EXPECT_THAT(toProgramParams(rtp(0.03, 1, 0)).reason, HasSubstr("tau_t"));
}

TEST(ParamsFromPhysics, RefusesNegativeAndNonFiniteNumbers) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_THAT(toProgramParams(abp(0.03, 0.5, -3)).reason, HasSubstr("eta"));
  EXPECT_THAT(toProgramParams(abp(nan, 0.5, 3)).reason, HasSubstr("finite"));
  EXPECT_THAT(toProgramParams(abp(0.03, inf, 3)).reason, HasSubstr("finite"));
  EXPECT_THAT(toProgramParams(wheelNoise(kBp, 0, -0.07, 0.2)).reason, HasSubstr("V "));
  EXPECT_THAT(toProgramParams(wheelNoise(kBp, 0, nan, 0.2)).reason, HasSubstr("finite"));
  EXPECT_THAT(toProgramParams(rtp(0.05, -1, 0.5)).reason, HasSubstr("gamma"));
  EXPECT_THAT(toProgramParams(rtp(0.05, 0, 0.5)).reason, HasSubstr("gamma"));
  EXPECT_THAT(toProgramParams(rtp(0.05, nan, 0.5)).reason, HasSubstr("finite"));
}

TEST(ParamsFromPhysics, RefusesABrownianParticleThatDrifts) {
  EXPECT_THAT(toProgramParams(wheelNoise(kBp, 0.01, 0.07, 0.2)).reason, HasSubstr("va"));
}

TEST(ParamsFromPhysics, RefusesAnUnknownKind) {
  RobotProgram p;
  p.kind = static_cast<ProgramKind>(9);
  EXPECT_THAT(toProgramParams(p).reason, HasSubstr("kind"));
}

}  // namespace
}  // namespace lab::dynamics::params_from_physics_test
