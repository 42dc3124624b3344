#include "light/photometry/tone_pictures.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "light/optics/simulated_camera.hpp"

namespace lab::calibration::tone_pictures_test {
namespace {

using testing::HasSubstr;

constexpr double kWidth = 1.2;
constexpr double kHeight = 0.9;
const std::vector<double> kValues{0.0, 0.1, 0.2, 0.3, 0.45, 0.6, 0.75, 0.9, 1.0};
const std::array<double, 5> kVignetting{0.05, 0, -0.12, 0, -0.10};

/// Places 10 cm apart with the projector's kVignetting, seen by a camera with its own falloff, with
/// noise [DN] on each mean.
std::vector<ToneObservation> observationsOf(double gamma, double noise, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;  // not constructed with width 0, which is undefined
  const optics::ProjectorTone tone(gamma, kVignetting, kWidth, kHeight);
  std::vector<ToneObservation> observations;
  for (double x = 0.05; x < kWidth; x += 0.1) {
    for (double y = 0.05; y < kHeight; y += 0.1) {
      const double a = 2 * x / kWidth - 1;
      const double b = 2 * y / kHeight - 1;
      const double camera = 180 * std::exp(-0.08 * (a * a + b * b) + 0.03 * a);
      ToneObservation observation{{x, y}, {}, false};
      for (const double value : kValues) {
        observation.grey.push_back(12 + camera * tone.light(value, {x, y}) +
                                   noise * normal(engine));
      }
      observations.push_back(std::move(observation));
    }
  }
  return observations;
}

ToneFromPictures fitted(const std::vector<ToneObservation>& observations, double gamma) {
  return fitTone(kValues, observations, {gamma, kVignetting, kWidth, kHeight}, kWidth, kHeight);
}

TEST(TonePictures, FindGammaAndTheKnownWhite) {
  const ToneFromPictures fit = fitted(observationsOf(2.2, 0, 1), 2.2);
  EXPECT_EQ(fit.refusal, "");
  EXPECT_EQ(fit.places, 108);
  EXPECT_NEAR(fit.gamma, 2.2, 1e-6);
  EXPECT_LT(fit.white_rms, 1e-6);
  EXPECT_LT(fit.residual, 1e-6);
}

TEST(TonePictures, ReturnTheErrorOfGamma) {
  constexpr int kFilms = 200;
  double squares = 0;
  double sum = 0;
  for (unsigned seed = 1; seed <= kFilms; ++seed) {
    const ToneFromPictures fit = fitted(observationsOf(1.8, 0.5, seed), 1.8);
    const double z = (fit.gamma - 1.8) / fit.gamma_sigma;
    sum += z;
    squares += z * z;
  }
  EXPECT_LT(std::abs(sum / std::sqrt(kFilms)), 4);
  EXPECT_NEAR(squares / kFilms, 1, 4 * std::sqrt(2.0 / kFilms));
}

TEST(TonePictures, LocateAShadow) {
  std::vector<ToneObservation> observations = observationsOf(2.2, 0.05, 3);
  ToneObservation& dark = observations[40];
  for (double& grey : dark.grey) grey = 12 + 0.8 * (grey - 12);
  const ToneFromPictures fit = fitted(observations, 2.2);
  EXPECT_DOUBLE_EQ(fit.worst_place.x, dark.place.x);
  EXPECT_DOUBLE_EQ(fit.worst_place.y, dark.place.y);
  EXPECT_NEAR(fit.white_worst, std::log(0.8), 0.03);
}

TEST(TonePictures, ReportTheReasonForNoResult) {
  std::vector<ToneObservation> observations = observationsOf(2.2, 0, 1);
  for (ToneObservation& observation : observations) observation.saturated = true;
  EXPECT_THAT(fitted(observations, 2.2).refusal, HasSubstr("108 are saturated"));
  for (ToneObservation& observation : observations) {
    observation.saturated = false;
    observation.grey.assign(kValues.size(), 20);
  }
  EXPECT_THAT(fitted(observations, 2.2).refusal, HasSubstr("a longer camera.exposure_ms"));
}

TEST(TonePictures, AverageTheFloorOfAPicture) {
  const optics::CameraParameters camera = optics::simulatedCamera(1280, 720, kWidth, kHeight);
  TonePictures pictures(camera, kWidth, kHeight, 0, 2);
  optics::GreyImage picture(1280, 720, 40);
  pictures.add(0, picture.view());
  pictures.add(1, picture.view());
  std::fill(picture.pixels.begin(), picture.pixels.end(), 60);
  pictures.add(1, picture.view());
  for (auto& pixel : picture.pixels) pixel = 255;
  const auto observations = pictures.observations();
  ASSERT_GE(observations.size(), 100U);
  for (const ToneObservation& observation : observations) {
    EXPECT_DOUBLE_EQ(observation.grey[0], 40);
    EXPECT_DOUBLE_EQ(observation.grey[1], 50);
    EXPECT_FALSE(observation.saturated);
  }
  pictures.add(0, picture.view());
  EXPECT_TRUE(pictures.observations().front().saturated);
}

}  // namespace
}  // namespace lab::calibration::tone_pictures_test
