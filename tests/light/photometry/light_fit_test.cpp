#include "light/photometry/light_fit.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "light/photometry/projector_tone.hpp"

namespace lab::calibration {
namespace {

constexpr double kWidth = 1.2;
constexpr double kHeight = 0.9;

struct Truth {
  double gamma = 2.2;
  std::array<double, 5> vignetting{0.03, -0.05, -0.12, 0.01, -0.15};
  double scale = 0.9;
  double ambient = 0.02;
  double gain_spread = 0.05;
  double noise = 0.002;
  int robots = 5;
  int levels = 9;
  int rounds = 6;
};

/// Simulated readings of a sequence of lights by robots at random places, which change in some
/// rounds.
std::vector<LightSample> measure(const Truth& truth, unsigned seed,
                                 std::map<SensorName, double>* gains = nullptr) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  const optics::ProjectorTone tone(truth.gamma, truth.vignetting, kWidth, kHeight);
  std::vector<LightSample> samples;
  std::map<SensorName, double> own;
  for (int robot = 1; robot <= truth.robots; ++robot) {
    own[{robot, false}] = std::exp(truth.gain_spread * normal(engine));
    own[{robot, true}] = std::exp(truth.gain_spread * normal(engine));
  }
  for (int round = 0; round < truth.rounds; ++round) {
    for (auto& [name, gain] : own) {
      const optics::Place place{kWidth * uniform(engine), kHeight * uniform(engine)};
      for (int level = 0; level < truth.levels; ++level) {
        const double value = level / (truth.levels - 1.0);
        const double reading = gain * (truth.ambient + truth.scale * tone.light(value, place)) +
                               truth.noise * normal(engine);
        samples.push_back({name, place, value, std::clamp(reading, 0.0, 1.0), truth.noise});
      }
    }
  }
  if (gains != nullptr) *gains = own;
  return samples;
}

TEST(LightFit, FindsGammaVignettingAndGainsWithinTheirErrors) {
  const Truth truth;
  double most = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const LightFit fit = fitLight(measure(truth, seed), kWidth, kHeight);
    ASSERT_EQ(fit.refusal, "");
    most = std::max(most, std::abs(fit.gamma - truth.gamma) / fit.gamma_sigma);
    EXPECT_LT(fit.gamma_sigma, 0.01);
    EXPECT_NEAR(fit.residual, truth.noise, 0.1 * truth.noise);
  }
  EXPECT_LT(most, 4) << "of 20 fits, in standard errors";
}

TEST(LightFit, PredictsReadingsAnywhere) {
  const Truth truth;
  std::map<SensorName, double> gains;
  const LightFit fit = fitLight(measure(truth, 3, &gains), kWidth, kHeight);
  const optics::ProjectorTone tone(truth.gamma, truth.vignetting, kWidth, kHeight);
  double worst = 0;
  for (double x = 0.05; x < kWidth; x += 0.1) {
    for (double y = 0.05; y < kHeight; y += 0.1) {
      for (const double value : {0.0, 0.1, 0.5, 0.9}) {
        const double reading =
            gains.at({2, true}) * (truth.ambient + truth.scale * tone.light(value, {x, y}));
        worst = std::max(
            worst, std::abs(fit.reading({2, true}, {x, y}, value, kWidth, kHeight) - reading));
      }
    }
  }
  EXPECT_LT(worst, 0.005) << "of full scale";
}

TEST(LightFit, ExcludesSaturatedReadings) {
  Truth truth;
  truth.scale = 1.4;
  const LightFit fit = fitLight(measure(truth, 4), kWidth, kHeight);
  EXPECT_EQ(fit.refusal, "");
  EXPECT_GT(fit.saturated, 10);
  EXPECT_NEAR(fit.gamma, truth.gamma, 0.03);
}

TEST(LightFit, RejectsTooFewLightsAndPlaces) {
  Truth few_levels;
  few_levels.levels = 3;
  EXPECT_THAT(fitLight(measure(few_levels, 5), kWidth, kHeight).refusal,
              testing::HasSubstr("3 different lights"));
  Truth few_places;
  few_places.robots = 1;
  few_places.rounds = 1;
  EXPECT_THAT(fitLight(measure(few_places, 6), kWidth, kHeight).refusal,
              testing::HasSubstr("2 places"));
  EXPECT_NE(fitLight({}, kWidth, kHeight).refusal, "");
}

TEST(LightFit, NamesABlindSensor) {
  std::vector<LightSample> samples = measure({}, 9);
  for (LightSample& sample : samples) {
    if (sample.sensor == SensorName{3, true}) sample.reading *= 0.02;
  }
  EXPECT_THAT(fitLight(samples, kWidth, kHeight).refusal,
              testing::HasSubstr("the front sensor of robot 3"));
}

TEST(LightFit, RejectsReadingsThatDoNotFitTheModel) {
  Truth shaded;
  shaded.noise = 0.05;
  EXPECT_THAT(fitLight(measure(shaded, 7), kWidth, kHeight).refusal,
              testing::HasSubstr("of full scale, allowed 2.00 %"));
}

TEST(ProjectorTone, GivesTheWantedLightWherePossible) {
  const optics::ProjectorTone tone(2.2, {0.03, -0.05, -0.12, 0.01, -0.15}, kWidth, kHeight);
  for (const optics::Place place : {optics::Place{0, 0}, {0.6, 0.45}, {1.2, 0.9}, {0.1, 0.8}}) {
    for (const double intensity : {0.0, 0.2, 0.7, 1.0}) {
      EXPECT_NEAR(tone.light(tone.value(intensity, place), place), intensity * tone.weakest(),
                  1e-12);
    }
  }
  EXPECT_TRUE(optics::ProjectorTone().isIdentity());
  EXPECT_EQ(optics::ProjectorTone().value(0.3, {0.1, 0.1}), 0.3);
}

}  // namespace
}  // namespace lab::calibration
