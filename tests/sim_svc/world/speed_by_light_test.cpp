// The stationary density of active Brownian particles whose speed v depends on the place is
// proportional to 1 / v: Schnitzer, Phys. Rev. E 48, 2553 (1993); Tailleur and Cates, Phys. Rev.
// Lett. 100, 218103 (2008).
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "tests/support/world_fixture.hpp"

namespace lab::sim::speed_by_light_test {
namespace {

constexpr double kPeriod = 2.4;    // [m] of the light along x
constexpr double kSlowest = 0.02;  // [m/s]
constexpr double kFastest = 0.08;  // [m/s]
constexpr std::size_t kBins = 12;
constexpr int kRobots = 100;

/// Light that repeats along x. Without walls in reach, the places within one period have a
/// stationary density.
class Wave : public LightSampler {
 public:
  [[nodiscard]] double at(double x, double /*y*/) const override { return of(x); }
  static double of(double x) { return 0.5 + 0.5 * std::cos(2 * std::numbers::pi * x / kPeriod); }
};

double speedAt(double x) { return kSlowest + (kFastest - kSlowest) * Wave::of(x); }

/// The share of each bin if the density is proportional to 1 / v.
std::array<double, kBins> expectedShares() {
  constexpr int kSteps = 1000;
  std::array<double, kBins> shares{};
  double all = 0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    for (int i = 0; i < kSteps; ++i) {
      const double x = (static_cast<double>(bin) + (i + 0.5) / kSteps) * kPeriod / kBins;
      shares[bin] += 1 / speedAt(x);
    }
    all += shares[bin];
  }
  for (double& share : shares) share /= all;
  return shares;
}

std::size_t binOf(double x) {
  const double within = x - kPeriod * std::floor(x / kPeriod);
  return std::min(kBins - 1, static_cast<std::size_t>(within / kPeriod * kBins));
}

TEST(SpeedByLight, GivesADensityProportionalToOneOverTheSpeed) {
  WorldSettings settings = idealHardware();
  settings.arena = {300, 300};
  settings.seed = 20;
  const Wave light;
  World world(settings, robots(kRobots));
  world.setLight(&light);
  startAll(
      world,
      always(shippedProgram(
          "speed_by_light",
          {{"v_min", "2 cm/s"}, {"v_max", "8 cm/s"}, {"eta", "5 rad/s"}, {"epsilon", "0.02 s"}})));
  // A robot forgets its place within the time of diffusion across half a period, about 10 s.
  constexpr std::int64_t kForget = 100 * kSecond;
  constexpr int kSamples = 1500;
  world.advanceTo(kForget);
  std::vector<std::array<double, kBins>> shares(kRobots, std::array<double, kBins>{});
  for (int sample = 1; sample <= kSamples; ++sample) {
    world.advanceTo(kForget + sample * kSecond);
    for (std::size_t i = 0; i < world.size(); ++i) {
      shares[i][binOf(world.pose(i).x)] += 1.0 / kSamples;
    }
  }

  const auto expected = expectedShares();
  EXPECT_GT(expected[kBins / 2], 3 * expected[0]) << "robots gather where it is dark";
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    double sum = 0;
    double squares = 0;
    for (const auto& robot : shares) {
      sum += robot[bin];
      squares += robot[bin] * robot[bin];
    }
    const double mean = sum / kRobots;
    const double error = std::sqrt((squares / kRobots - mean * mean) / (kRobots - 1));
    EXPECT_LT(std::abs(mean - expected[bin]), 4 * error)
        << "bin " << bin << ": " << mean << " +- " << error << ", expected " << expected[bin];
    EXPECT_LT(error, 0.06 * expected[bin]) << "the test must be able to fail";
  }
}

}  // namespace
}  // namespace lab::sim::speed_by_light_test
