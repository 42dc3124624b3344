// Fits of simulated projectors with known lenses.
#include "projector_ctl/calibration/projector_fit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "common/math/random.hpp"
#include "light/optics/simulated_projector.hpp"

namespace lab::calibration::projector_fit_test {
namespace {

using optics::Pixel;
using optics::Place;
using optics::ProjectorModel;
using testing::HasSubstr;

constexpr double kWidth = 1.2;
constexpr double kHeight = 0.9;
const ProjectorPlane kPlane{1920, 1080, kWidth, kHeight, optics::kSensorHeight};

ProjectorModel projector(const optics::ProjectorFaults& faults) {
  return optics::simulatedProjector(kWidth, kHeight, kPlane.columns, kPlane.rows, faults);
}

bool isLit(const Pixel& pixel) {
  return pixel.x > -0.5 && pixel.y > -0.5 && pixel.x < kPlane.columns - 0.5 &&
         pixel.y < kPlane.rows - 0.5;
}

/// Observations every 2 cm with noise `sigma` [px]; the fit gets the noise `told`.
std::vector<ProjectorObservation> observationsOf(const ProjectorModel& real, double sigma,
                                                 Random& random, double told = 0.05) {
  std::vector<ProjectorObservation> observations;
  for (double y = 0.01; y < kHeight; y += 0.02) {
    for (double x = 0.01; x < kWidth; x += 0.02) {
      const Pixel pixel = real.pixelOf({x, y});
      if (!isLit(pixel)) continue;
      observations.push_back(
          {{x, y}, {pixel.x + sigma * random.normal(), pixel.y + sigma * random.normal()}, told});
    }
  }
  return observations;
}

/// [m] rms distance over the arena between commanded and actual positions of light.
double trueError(const optics::CameraParameters& lens, const ProjectorModel& real) {
  const ProjectorModel assumed(lens, optics::kSensorHeight);
  double sum = 0;
  int count = 0;
  for (int j = 0; j <= 9; ++j) {
    for (int i = 0; i <= 12; ++i) {
      const Place place{kWidth * i / 12, kHeight * j / 9};
      const auto wanted = assumed.placeOf(real.pixelOf(place));
      if (!wanted) return HUGE_VAL;
      sum += std::pow(wanted->x - place.x, 2) + std::pow(wanted->y - place.y, 2);
      ++count;
    }
  }
  return std::sqrt(sum / count);
}

TEST(ProjectorFit, ClaimedErrorIsCorrectForManyLenses) {
  // The error of one fit depends on about ten random numbers; the mean square over many fits must
  // equal the claim.
  double claimed = 0;
  double found = 0;
  int fits = 0;
  for (const optics::ProjectorFaults& faults : {optics::ProjectorFaults{},
                                                {0.15, 0.08, 0, 0},
                                                {-0.2, 0, 0, 0},
                                                {0, -0.06, 0, 0},
                                                {0.05, 0.12, 0.002, -0.003},
                                                {0.3, 0.02, 0, 0}}) {
    const ProjectorModel real = projector(faults);
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      Random random(100 * seed + static_cast<std::uint64_t>(fits));
      const ProjectorFit fit = fitProjector(observationsOf(real, 0.4, random), kPlane);
      EXPECT_EQ(fit.refusal, "");
      EXPECT_LE(fit.outlying, 2);  // of 2700, beyond five standard deviations
      const double error = trueError(fit.lens, real);
      EXPECT_LT(error, 0.1e-3);
      claimed += fit.accuracy * fit.accuracy;
      found += error * error;
      ++fits;
    }
  }
  EXPECT_NEAR(std::sqrt(found / claimed), 1, 0.2);
}

TEST(ProjectorFit, FindsTheLensItselfWithoutNoise) {
  Random random(1);
  const ProjectorModel real = projector({0.15, 0.08, 0, 0});
  const ProjectorFit fit = fitProjector(observationsOf(real, 0, random), kPlane);
  EXPECT_EQ(fit.refusal, "");
  EXPECT_LT(trueError(fit.lens, real), 1e-7);
  EXPECT_NEAR(fit.covered, 1, 1e-12);
}

TEST(ProjectorFit, ClaimedErrorIncludesTheCamera) {
  // A camera with a scale error of 0.05 % along x.
  Random random(1);
  const ProjectorModel real = projector({0.15, 0.08, 0, 0});
  std::vector<ProjectorObservation> observations = observationsOf(real, 0.1, random);
  double camera = 0;
  for (ProjectorObservation& observation : observations) {
    const double off = 5e-4 * (observation.place.x - kWidth / 2);
    camera += off * off;
    observation.place.x += off;
  }
  camera = std::sqrt(camera / static_cast<double>(observations.size()));
  const ProjectorFit fit = fitProjector(observations, kPlane, camera);
  EXPECT_EQ(fit.refusal, "");
  EXPECT_NEAR(fit.accuracy / trueError(fit.lens, real), 1, 0.2);
}

TEST(ProjectorFit, DeviationsFromTheLensModelAreReportedAsMisfit) {
  // A board with waves of about 0.2 mm.
  Random random(1);
  const ProjectorModel real = projector({0.1, 0.05, 0, 0});
  std::vector<ProjectorObservation> observations;
  const auto waved = [](const Place& place) {
    return Place{place.x + 2e-4 * std::sin(20 * place.y), place.y + 2e-4 * std::cos(18 * place.x)};
  };
  for (const ProjectorObservation& observation : observationsOf(real, 0.1, random)) {
    observations.push_back({waved(observation.place), observation.pixel, observation.sigma});
  }
  const ProjectorFit fit = fitProjector(observations, kPlane);
  EXPECT_EQ(fit.refusal, "");
  // The projector lights the positions with the waves.
  const ProjectorModel assumed(fit.lens, optics::kSensorHeight);
  double sum = 0;
  int count = 0;
  for (double y = 0.05; y < kHeight; y += 0.05) {
    for (double x = 0.05; x < kWidth; x += 0.05) {
      const Place wanted = *assumed.placeOf(real.pixelOf({x, y}));
      const Place falls = waved({x, y});
      sum += std::pow(wanted.x - falls.x, 2) + std::pow(wanted.y - falls.y, 2);
      ++count;
    }
  }
  EXPECT_NEAR(fit.accuracy / std::sqrt(sum / count), 1, 0.2);
}

TEST(ProjectorFit, ShadowsAndGlareAreExcluded) {
  Random random(3);
  const ProjectorModel real = projector({0.15, 0.08, 0, 0});
  std::vector<ProjectorObservation> observations = observationsOf(real, 0.1, random);
  int strangers = 0;
  for (std::size_t i = 0; i < observations.size(); i += 9) {
    observations[i].pixel.x += 30 + 100 * random.uniform();
    observations[i].pixel.y -= 40 * random.uniform();
    ++strangers;
  }
  const ProjectorFit fit = fitProjector(observations, kPlane);
  EXPECT_EQ(fit.refusal, "");
  EXPECT_EQ(fit.outlying, strangers);
  EXPECT_LT(trueError(fit.lens, real), 0.05e-3);
}

TEST(ProjectorFit, HandlesMirroredAndRotatedPictures) {
  Random random(4);
  const ProjectorModel real = projector({0.15, 0.08, 0, 0});
  for (const bool mirrored : {false, true}) {
    std::vector<ProjectorObservation> observations = observationsOf(real, 0.1, random);
    for (ProjectorObservation& observation : observations) {
      if (!mirrored) observation.pixel.x = kPlane.columns - 1 - observation.pixel.x;
      observation.pixel.y = kPlane.rows - 1 - observation.pixel.y;
    }
    const ProjectorFit fit = fitProjector(observations, kPlane);
    EXPECT_EQ(fit.refusal, "");
    EXPECT_LT(fit.residual, 0.2e-3);
  }
}

TEST(ProjectorFit, RefusalsGiveTheReason) {
  Random random(5);
  const ProjectorModel real = projector({0.15, 0.08, 0, 0});
  std::vector<ProjectorObservation> observations = observationsOf(real, 0.1, random);
  EXPECT_THAT(fitProjector({observations.begin(), observations.begin() + 50}, kPlane).refusal,
              HasSubstr("seen in 50 places, needed 200"));
  EXPECT_THAT(fitProjector({}, kPlane).refusal, HasSubstr("seen in 0 places"));
  // Only the left half.
  std::vector<ProjectorObservation> half;
  for (const ProjectorObservation& observation : observations) {
    if (observation.place.x < kWidth / 2) half.push_back(observation);
  }
  EXPECT_THAT(fitProjector(half, kPlane).refusal, HasSubstr("on 50 % of the arena"));
  // A picture that is shifted away from two corners.
  EXPECT_THAT(fitProjector(observationsOf(projector({0, 0, 0.04, 0}), 0.1, random), kPlane).refusal,
              HasSubstr("corner (0, 0) cm and (0, 90) cm: move"));
  // A board that is not flat.
  for (ProjectorObservation& observation : observations) {
    observation.place.x +=
        3e-3 * std::sin(25 * observation.place.x) * std::cos(20 * observation.place.y);
  }
  EXPECT_THAT(fitProjector(observations, kPlane).refusal, HasSubstr("mm (rms), allowed 1.00 mm"));
}

TEST(LensFromCorners, LightsTheCornersWithThesePixels) {
  Random random(6);
  int far = 0;
  int none = 0;
  const auto place = [](std::size_t i) {
    return Place{i == 1 || i == 2 ? kWidth : 0, i >= 2 ? kHeight : 0};
  };
  for (int n = 0; n < 100; ++n) {
    std::array<Pixel, 4> corners;
    for (std::size_t i = 0; i < 4; ++i) {
      corners[i] = {place(i).x / kWidth * 1919 + 100 * (2 * random.uniform() - 1),
                    (1 - place(i).y / kHeight) * 1079 + 60 * (2 * random.uniform() - 1)};
    }
    if (n % 2 == 1) {  // mirrored
      std::swap(corners[0], corners[1]);
      std::swap(corners[2], corners[3]);
    }
    const auto lens = lensFromCorners(corners, kPlane);
    if (!lens) {
      ++none;
      continue;
    }
    const ProjectorModel model(*lens, kPlane.height);
    for (std::size_t i = 0; i < 4; ++i) {
      const Pixel pixel = model.pixelOf(place(i));
      const double miss = std::hypot(pixel.x - corners[i].x, pixel.y - corners[i].y);
      EXPECT_LT(miss, 0.5);
      far += miss > 0.01 ? 1 : 0;
    }
  }
  // Corners to which hardly any lens maps a rectangle.
  EXPECT_LE(far, 4 * 4);
  EXPECT_LE(none, 2);
}

TEST(LensFromCorners, NoneForCornersThatCross) {
  EXPECT_FALSE(lensFromCorners({{{0, 0}, {1919, 1079}, {1919, 0}, {0, 1079}}}, kPlane));
  EXPECT_FALSE(lensFromCorners({{{0, 0}, {0, 0}, {0, 0}, {0, 0}}}, kPlane));
}

}  // namespace
}  // namespace lab::calibration::projector_fit_test
