#include "analyzer/laws/observation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/analyzer/laws/window_moments.hpp"
#include "tests/analyzer/paper_programs.hpp"

namespace lab::analysis {
namespace {

TEST(Observation, AddsNoiseAndChangesNothingWithoutExposure) {
  const ExactLaw law(abpLaw(3, 0.5, 0.03));
  EXPECT_EQ(observedMsd(law, {}, 0.7), law.msd(0.7));
  EXPECT_NEAR(observedMsd(law, {0, 0.001, 0.02}, 0.7), law.msd(0.7) + 4e-6, 1e-18);
  EXPECT_NEAR(observedAngularMsd(law, {0, 0.001, 0.02}, 0.7), law.angularMsd(0.7) + 8e-4, 1e-15);
}

TEST(Observation, IsNanWithoutALaw) {
  for (const ProgramLaw& program : {ProgramLaw{}, rtpLaw(3, 0, 0.05), abpLaw(3, 0, 0.03)}) {
    const ExactLaw law(program);
    for (const double exposure : {0.0, 0.1}) {
      EXPECT_TRUE(std::isnan(observedMsd(law, {exposure, 0.001, 0.02}, 0.7))) << exposure;
      EXPECT_TRUE(std::isnan(observedAngularMsd(law, {exposure, 0.001, 0.02}, 0.7))) << exposure;
    }
  }
}

TEST(Observation, IsTheDoubleIntegralOverBothExposures) {
  const auto direct = [](auto msd, double tau, double exposure) {
    constexpr int kSteps = 500;
    double sum = 0;
    for (int i = -kSteps + 1; i < kSteps; ++i) {
      const double w = exposure * i / kSteps;
      sum += (kSteps - std::abs(i)) * (msd(std::abs(tau + w)) - msd(std::abs(w)));
    }
    return sum / (static_cast<double>(kSteps) * kSteps);
  };
  for (const ProgramLaw& program : {abpLaw(6, 0.25, 0.03), noisyLaw(0.01, 0.1, 0.1),
                                    noisyLaw(0, 0.07, 0.2), rtpLaw(3, 0.5, 0.05)}) {
    const ExactLaw law(program);
    for (const double exposure : {0.01, 0.1, 0.37, 1.2}) {
      for (const double tau : {0.02, 0.1, 0.3, 1.0, 10.0}) {
        const MeasurementModel seen{exposure, 0, 0};
        const double msd = direct([&](double t) { return law.msd(t); }, tau, exposure);
        EXPECT_NEAR(observedMsd(law, seen, tau) / msd, 1, 3e-5) << exposure << " " << tau;
        const double turn = direct([&](double t) { return law.angularMsd(t); }, tau, exposure);
        EXPECT_NEAR(observedAngularMsd(law, seen, tau) / turn, 1, 3e-5) << exposure << " " << tau;
      }
    }
  }
}

TEST(Observation, HasAClosedFormForAnExponentialCorrelation) {
  const ProgramLaw program = rtpLaw(3, 0.5, 0.05);
  const ExactLaw law(program);
  const RunsAndTurns runs = *program->runs();
  const double rate = runs.rate;
  const double c = runs.speed * runs.speed / (1 + runs.rate * runs.turn_time);
  for (const double e : {0.02, 0.1, 0.6}) {
    for (const double tau : {0.6, 1.0, 5.0}) {
      const double kept = 2 * (std::cosh(rate * e) - 1) / (rate * rate * e * e);
      const double lost = 2 * (rate * e + std::expm1(-rate * e)) / (rate * rate * e * e);
      const double expected = 2 * c / rate * (tau - e / 3) +
                              2 * c / (rate * rate) * (std::exp(-rate * tau) * kept - lost);
      EXPECT_NEAR(observedMsd(law, {e, 0, 0}, tau) / expected, 1, 1e-12) << e << " " << tau;
    }
  }
}

TEST(Observation, MotionBlurHasTheKnownValues) {
  const auto loss = [](const ProgramLaw& program, double frame, double exposure) {
    const ExactLaw law(program);
    return 100 * (observedMsd(law, {exposure, 0, 0}, frame) / law.msd(frame) - 1);
  };
  EXPECT_NEAR(loss(abpLaw(3, 0.5, 0.03), 0.1, 0.1), -0.23, 0.01);
  EXPECT_NEAR(loss(noisyLaw(0.01, 0.1, 0.1), 0.02, 0.02), -2.7, 0.1);
  EXPECT_NEAR(loss(noisyLaw(0.01, 0.1, 0.1), 0.1, 0.1), -16, 0.5);
}

TEST(Observation, AgreesWithSimulatedExposures) {
  // The position is averaged over 40 instants, which stands for an exposure of 40/39 of their span
  // to third order in the step.
  const ProgramLaw program = noisyLaw(0.01, 0.1, 0.1);
  const double exposure = 0.08;
  const double tau = 0.1;
  constexpr int kInstants = 40;
  const double span = exposure * (kInstants - 1) / kInstants;
  std::mt19937_64 random(7);
  const DrawnWheels wheels = *program->drawnWheels();
  const double hold = program->held()->hold;
  std::uniform_real_distribution<double> wheel(wheels.mean - wheels.half_width,
                                               wheels.mean + wheels.half_width);
  std::uniform_real_distribution<double> phase(0, hold);
  WindowMoments moments;
  for (int robot = 0; robot < 40'000; ++robot) {
    double left = phase(random);
    double l = wheel(random);
    double r = wheel(random);
    double x = 0;
    double y = 0;
    double theta = 0;
    double mean[2][2] = {{0, 0}, {0, 0}};
    double time = 0;
    const auto drive = [&](double until) {
      while (time < until) {
        const double dt = std::min(left, until - time);
        const double half = 0.5 * (r - l) / program->wheelBase() * dt;
        const double chord = 0.5 * (l + r) * dt * (half == 0 ? 1 : std::sin(half) / half);
        x += chord * std::cos(theta + half);
        y += chord * std::sin(theta + half);
        theta += 2 * half;
        time += dt;
        left -= dt;
        if (left <= 0) {
          left = hold;
          l = wheel(random);
          r = wheel(random);
        }
      }
    };
    for (int end = 0; end < 2; ++end) {
      for (int i = 0; i < kInstants; ++i) {
        drive(end * tau + span * i / (kInstants - 1));
        mean[end][0] += x / kInstants;
        mean[end][1] += y / kInstants;
      }
    }
    const double dx = mean[1][0] - mean[0][0];
    const double dy = mean[1][1] - mean[0][1];
    moments.add(dx * dx + dy * dy);
  }
  EXPECT_LT(std::abs(moments.z(observedMsd(ExactLaw(program), {exposure, 0, 0}, tau))), 4);
}

}  // namespace
}  // namespace lab::analysis
