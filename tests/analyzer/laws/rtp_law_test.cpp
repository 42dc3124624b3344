#include "analyzer/laws/rtp_law.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "analyzer/laws.hpp"
#include "tests/analyzer/laws/window_moments.hpp"
#include "tests/analyzer/paper_programs.hpp"

namespace lab::analysis::rtp_law_test {
namespace {

constexpr double kPi = std::numbers::pi;

struct Parameters {
  double v;
  double gamma;
  double tau_t;
};

/// Windows of independent robots, each from the stationary state: displacement and rotation after
/// each of `lags` (s, ascending).
class RtpWindows {
 public:
  RtpWindows(const Parameters& p, std::function<double(std::mt19937_64&)> angle,
             const std::vector<double>& lags)
      : p_(p), angle_(std::move(angle)), lags_(lags), moved(lags.size()), turned(lags.size()) {}

  void run(int robots, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    for (int i = 0; i < robots; ++i) one(random);
  }

 private:
  void one(std::mt19937_64& random) {
    std::uniform_real_distribution<double> unit(0, 1);
    std::exponential_distribution<double> run(p_.gamma);
    double x = 0;
    double y = 0;
    double theta = 0;
    double time = 0;
    bool tumbling = unit(random) < p_.gamma * p_.tau_t / (1 + p_.gamma * p_.tau_t);
    double left = tumbling ? p_.tau_t * unit(random) : run(random);
    double rate = tumbling ? angle_(random) / p_.tau_t : 0;
    for (std::size_t i = 0; i < lags_.size();) {
      const double dt = std::min(left, lags_[i] - time);
      x += tumbling ? 0 : p_.v * std::cos(theta) * dt;
      y += tumbling ? 0 : p_.v * std::sin(theta) * dt;
      theta += rate * dt;
      time += dt;
      left -= dt;
      if (left <= 0) {
        tumbling = !tumbling;
        left = tumbling ? p_.tau_t : run(random);
        rate = tumbling ? angle_(random) / p_.tau_t : 0;
      } else {
        moved[i].add(x * x + y * y);
        turned[i].add(theta * theta);
        ++i;
      }
    }
  }

  Parameters p_;
  std::function<double(std::mt19937_64&)> angle_;
  std::vector<double> lags_;

 public:
  std::vector<WindowMoments> moved;
  std::vector<WindowMoments> turned;
};

struct Case {
  const char* name;
  Parameters parameters;
  Turning turning;
  std::function<double(std::mt19937_64&)> angle;
};

std::function<double(std::mt19937_64&)> uniform(double low, double high) {
  return [=](std::mt19937_64& random) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
}

TEST(RtpLaw, AgreesWithSimulatedRobotsForAnyTurning) {
  const double limit = 3.6;
  const std::vector<Case> cases = {
      {"full circle", {0.05, 3, 0.5}, {}, uniform(-kPi, kPi)},
      {"narrow and biased", {0.05, 1, 0.5}, Turning::uniform(-0.5, 1.5), uniform(-0.5, 1.5)},
      {"0 to 360 degrees, saturated",
       {0.05, 3, 0.5},
       Turning::clipped(0, 2 * kPi, limit),
       [=](std::mt19937_64& random) {
         return std::min(limit, std::uniform_real_distribution<double>(0, 2 * kPi)(random));
       }},
      {"backwards",
       {0.05, 2, 0.2},
       Turning::uniform(kPi, kPi),
       [](std::mt19937_64&) { return kPi; }},
      {"0 to 360 degrees", {0.05, 2, 0.7}, Turning::uniform(0, 2 * kPi), uniform(0, 2 * kPi)}};
  const std::vector<double> lags = {0.05, 0.3, 0.5, 0.9, 1.7, 4, 12};
  std::uint64_t seed = 1;
  for (const Case& one : cases) {
    RtpWindows windows(one.parameters, one.angle, lags);
    windows.run(100'000, seed++);
    const RtpLaw dut(one.parameters.v, one.parameters.gamma, one.parameters.tau_t, one.turning);
    for (std::size_t i = 0; i < lags.size(); ++i) {
      EXPECT_LT(std::abs(windows.moved[i].z(dut.msd(lags[i]))), 4) << one.name << " " << lags[i];
      EXPECT_LT(std::abs(windows.turned[i].z(dut.angularMsd(lags[i]))), 4)
          << one.name << " " << lags[i];
    }
  }
}

TEST(RtpLaw, IsEquation6OnTheFullCircle) {
  const ProgramLaw law = rtpLaw(3, 0.5);
  const RtpLaw dut(0.05, 3, 0.5);
  for (const double tau : {1e-6, 1e-3, 0.1, 0.33, 0.34, 1.0, 10.0, 1e4}) {
    EXPECT_NEAR(dut.msd(tau) / law->paperMsd(tau), 1, 1e-13) << tau;
  }
  EXPECT_EQ(dut.msd(0), 0);
  EXPECT_EQ(dut.angularMsd(0), 0);
}

TEST(RtpLaw, DriftOfTheHeadingHasAClosedFormInsideATumble) {
  const double gamma = 1;
  const double t = 0.5;
  const double share = 1 / (1 + gamma * t);
  const RtpLaw dut(0.05, gamma, t, Turning::uniform(0, 2 * kPi));
  for (const double tau : {0.01, 0.1, 0.2, 0.3, 0.5}) {
    const double own = tau * tau * (1 - tau / (3 * t));
    const double tumbled2 = (1 - 2 * share) * tau * tau +
                            2 * share / (gamma * gamma) * (gamma * tau + std::expm1(-gamma * tau));
    const double expected = (kPi * kPi / 3 * (1 - share) * own + kPi * kPi * tumbled2) / (t * t);
    EXPECT_NEAR(dut.angularMsd(tau) / expected, 1, 1e-12) << tau;
  }
  // Ballistic in the end, at the mean rate.
  EXPECT_NEAR(std::sqrt(dut.angularMsd(1e4)) / 1e4 / dut.drift(), 1, 1e-3);
  EXPECT_DOUBLE_EQ(dut.drift(), kPi / 1.5);
}

TEST(RtpLaw, SlopeOfTheMsdIsItsDiffusivity) {
  for (const Turning& turning :
       {Turning::uniform(-0.5, 1.5), Turning::clipped(0, 2 * kPi, 3.6), Turning{}}) {
    const RtpLaw dut(0.05, 3, 0.5, turning);
    EXPECT_NEAR((dut.msd(250) - dut.msd(200)) / (4 * 50 * dut.diffusivity()), 1, 1e-9);
    double integral = 0;
    const double step = 2e-3;
    for (double s = step / 2; s < 120; s += step) integral += step * dut.velocityCorrelation(s);
    EXPECT_NEAR(integral / (2 * dut.diffusivity()), 1, 2e-5);
  }
  // z close to 1 keeps many tumbles in the sum: a direction lasts for two minutes.
  const RtpLaw slow(0.05, 3, 0.5, Turning::uniform(-0.2, 0.2));
  EXPECT_NEAR((slow.msd(5000) - slow.msd(4900)) / (4 * 100 * slow.diffusivity()), 1, 1e-9);
  EXPECT_TRUE(std::isinf(RtpLaw(0.05, 3, 0.5, Turning::uniform(0, 0)).diffusivity()));
}

TEST(RtpLaw, SaturatedWheelsTurnTooLittle) {
  // 0 to 360 degrees in half a second on wheels of 27 cm/s, 7.5 cm apart.
  const Turning turning = Turning::clipped(0, 2 * kPi, 2 * 0.27 / 0.075 * 0.5);
  EXPECT_NEAR(turning.z.real(), -0.45, 0.005);
  EXPECT_NEAR(turning.z.imag(), 0.11, 0.005);
  const double ratio =
      RtpLaw(0.05, 3, 0.5, turning).diffusivity() / RtpLaw(0.05, 3, 0.5).diffusivity();
  EXPECT_NEAR(ratio, 0.68, 0.01);
}

}  // namespace
}  // namespace lab::analysis::rtp_law_test
