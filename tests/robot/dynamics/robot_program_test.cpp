#include "robot/dynamics/robot_program.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace lab::dynamics::params_from_physics_test {
namespace {

using ::testing::HasSubstr;

ProgramPhysics abp(double v, double epsilon, double eta) {
  ProgramPhysics p;
  p.kind = kAbp;
  p.v = v;
  p.epsilon = epsilon;
  p.eta = eta;
  return p;
}

ProgramPhysics wheelNoise(ProgramKind kind, double va, double V, double epsilon) {
  ProgramPhysics p;
  p.kind = kind;
  p.va = va;
  p.V = V;
  p.epsilon = epsilon;
  return p;
}

ProgramPhysics rtp(double v, double gamma, double tau_t) {
  ProgramPhysics p;
  p.kind = kRtp;
  p.v = v;
  p.gamma = gamma;
  p.tau_t = tau_t;
  return p;
}

TEST(ParamsFromPhysics, ConvertsThePapersPrograms) {
  const ParamsResult abp_2b = paramsFromPhysics(abp(0.03, 0.5, 3));
  ASSERT_TRUE(abp_2b.ok) << abp_2b.reason;
  EXPECT_EQ(abp_2b.params.kind, kAbp);
  EXPECT_EQ(abp_2b.params.speed_um_s, 30000);
  EXPECT_EQ(abp_2b.params.amplitude_um_s, 112500);
  EXPECT_EQ(abp_2b.params.hold_ms, 500U);

  const ParamsResult noisy_3b = paramsFromPhysics(wheelNoise(kNoisyAbp, 0.01, 0.10, 0.1));
  ASSERT_TRUE(noisy_3b.ok) << noisy_3b.reason;
  EXPECT_EQ(noisy_3b.params.speed_um_s, 10000);
  EXPECT_EQ(noisy_3b.params.amplitude_um_s, 100000);

  const ParamsResult rtp_4b = paramsFromPhysics(rtp(0.05, 3, 0.5));
  ASSERT_TRUE(rtp_4b.ok) << rtp_4b.reason;
  EXPECT_EQ(rtp_4b.params.mean_run_us, 333333U);
  EXPECT_EQ(rtp_4b.params.tumble_ms, 500U);
  EXPECT_EQ(rtp_4b.params.tumble_amplitude_um_s, 235619);
}

TEST(ParamsFromPhysics, GoesThereAndBack) {
  const ProgramPhysics p = physicsFromParams(paramsFromPhysics(rtp(0.05, 4, 0.5004)).params);
  EXPECT_EQ(p.kind, kRtp);
  EXPECT_DOUBLE_EQ(p.v, 0.05);
  EXPECT_DOUBLE_EQ(p.gamma, 4);
  EXPECT_DOUBLE_EQ(p.tau_t, 0.5) << "what is executed, not what was asked for";
  const ProgramPhysics q = physicsFromParams(paramsFromPhysics(abp(0.03, 0.5, 3)).params);
  EXPECT_DOUBLE_EQ(q.eta, 3);
  const ProgramPhysics b =
      physicsFromParams(paramsFromPhysics(wheelNoise(kBp, 0, 0.07, 0.2)).params);
  EXPECT_DOUBLE_EQ(b.V, 0.07);
  EXPECT_DOUBLE_EQ(b.va, 0);
}

TEST(ParamsFromPhysics, RefusesWhatTheWheelsCannotDo) {
  const ParamsResult fast_turn = paramsFromPhysics(abp(0.03, 0.5, 6.5));
  EXPECT_FALSE(fast_turn.ok);
  EXPECT_THAT(fast_turn.reason, HasSubstr("|v| + eta d / 2"));
  EXPECT_THAT(fast_turn.reason, HasSubstr("27.38 cm/s"));
  EXPECT_THAT(fast_turn.reason, HasSubstr("27 cm/s"));
  EXPECT_TRUE(paramsFromPhysics(abp(0.03, 0.5, 6.4)).ok) << "a limit met exactly is allowed";

  const ParamsResult backward = paramsFromPhysics(abp(-0.05, 0.5, 6));
  EXPECT_FALSE(backward.ok) << "driving backward needs as much";

  const ParamsResult noise = paramsFromPhysics(wheelNoise(kNoisyAbp, -0.02, 0.26, 0.1));
  EXPECT_FALSE(noise.ok);
  EXPECT_THAT(noise.reason, HasSubstr("V + |va|"));
  EXPECT_THAT(noise.reason, HasSubstr("28 cm/s"));

  const ParamsResult tumble = paramsFromPhysics(rtp(0.05, 3, 0.43));
  EXPECT_FALSE(tumble.ok);
  EXPECT_THAT(tumble.reason, HasSubstr("tau_t"));
  EXPECT_THAT(tumble.reason, HasSubstr("at least 0.437 s"));
  EXPECT_TRUE(paramsFromPhysics(rtp(0.05, 3, 0.437)).ok);

  ProgramPhysics wheels;
  wheels.kind = kWheels;
  wheels.wheel_right = -0.3;
  EXPECT_THAT(paramsFromPhysics(wheels).reason, HasSubstr("right wheel"));
}

TEST(ParamsFromPhysics, RefusesTimesBelowAMillisecond) {
  EXPECT_THAT(paramsFromPhysics(abp(0.03, 0.0009, 3)).reason, HasSubstr("epsilon"));
  EXPECT_THAT(paramsFromPhysics(abp(0.03, 0, 3)).reason, HasSubstr("epsilon"));
  EXPECT_THAT(paramsFromPhysics(abp(0.03, -0.5, 3)).reason, HasSubstr("epsilon"));
  EXPECT_TRUE(paramsFromPhysics(abp(0.03, 0.001, 3)).ok);
  EXPECT_THAT(paramsFromPhysics(rtp(0.03, 1, 0)).reason, HasSubstr("tau_t"));
}

TEST(ParamsFromPhysics, RefusesNegativeAndNonFiniteNumbers) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_THAT(paramsFromPhysics(abp(0.03, 0.5, -3)).reason, HasSubstr("eta"));
  EXPECT_THAT(paramsFromPhysics(abp(nan, 0.5, 3)).reason, HasSubstr("finite"));
  EXPECT_THAT(paramsFromPhysics(abp(0.03, inf, 3)).reason, HasSubstr("finite"));
  EXPECT_THAT(paramsFromPhysics(wheelNoise(kBp, 0, -0.07, 0.2)).reason, HasSubstr("V "));
  EXPECT_THAT(paramsFromPhysics(wheelNoise(kBp, 0, nan, 0.2)).reason, HasSubstr("finite"));
  EXPECT_THAT(paramsFromPhysics(rtp(0.05, -1, 0.5)).reason, HasSubstr("gamma"));
  EXPECT_THAT(paramsFromPhysics(rtp(0.05, 0, 0.5)).reason, HasSubstr("gamma"));
  EXPECT_THAT(paramsFromPhysics(rtp(0.05, nan, 0.5)).reason, HasSubstr("finite"));
}

TEST(ParamsFromPhysics, RefusesABrownianParticleThatDrifts) {
  EXPECT_THAT(paramsFromPhysics(wheelNoise(kBp, 0.01, 0.07, 0.2)).reason, HasSubstr("va"));
}

TEST(ParamsFromPhysics, RefusesAnUnknownKind) {
  ProgramPhysics p;
  p.kind = static_cast<ProgramKind>(9);
  EXPECT_THAT(paramsFromPhysics(p).reason, HasSubstr("kind"));
}

}  // namespace
}  // namespace lab::dynamics::params_from_physics_test
