#include "tracker_svc/calibration/camera_fit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <utility>

#include "tests/tracker_svc/calibration/synthetic_camera.hpp"

namespace lab::calibration {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kColumns = 1280;
constexpr int kRows = 720;

/// Errors over the arena for many cameras, and the claimed errors [m].
struct Score {
  double rms = 0;
  double claimed = 0;
  double shape = 0;
  double z2 = 0;
  double largest_pull = 0;
};

Score scoreOf(int cameras, int caps, int boards, double corners) {
  Score score;
  for (int seed = 0; seed < cameras; ++seed) {
    Random random(static_cast<std::uint64_t>(seed), 9);
    const optics::CameraParameters camera = someCamera(random, kColumns, kRows);
    const SightNoise noise{0.02, corners, 5e-4 * random.normal()};
    CameraObservations observations = observationsOf(camera, caps, noise, random);
    for (int i = 0; i < boards; ++i) observations.boards.push_back(boardSeen(camera, 0.02, random));
    const CameraFit fit = fitCamera(observations);
    EXPECT_THAT(fit.refusal, IsEmpty()) << "camera " << seed;
    const TrueError error = trueError(fit, camera, observations);
    score.rms += error.rms * error.rms / cameras;
    score.claimed += fit.map.rms * fit.map.rms / cameras;
    score.shape += error.shape * error.shape / cameras;
    score.z2 += error.rms * error.rms / (fit.map.rms * fit.map.rms * cameras);
    score.largest_pull = std::max(score.largest_pull, error.largest_pull);
  }
  score.rms = std::sqrt(score.rms);
  score.claimed = std::sqrt(score.claimed);
  score.shape = std::sqrt(score.shape);
  testing::Test::RecordProperty("rms_um", std::to_string(1e6 * score.rms));
  testing::Test::RecordProperty("claimed_um", std::to_string(1e6 * score.claimed));
  testing::Test::RecordProperty("z2", std::to_string(score.z2));
  testing::Test::RecordProperty("largest_pull", std::to_string(score.largest_pull));
  return score;
}

// For n cameras with about 3 degrees of freedom each, the mean of z^2 is 1 +- sqrt(2 / 3n).

TEST(CameraFit, FindsCamerasFromCornersAndCaps) {
  const Score score = scoreOf(12, 400, 0, 0.2);
  EXPECT_LT(score.rms, 0.7e-3);
  EXPECT_LT(score.shape, 0.35e-3);
  EXPECT_LT(score.z2, 1 + 3 * std::sqrt(2 / 36.0));
  EXPECT_GT(score.z2, 0.2);
  EXPECT_LT(score.largest_pull, 4);
}

TEST(CameraFit, FindsCamerasFromABoardCornersAndCaps) {
  const Score score = scoreOf(12, 200, 8, 0.2);
  EXPECT_LT(score.rms, 0.5e-3);
  EXPECT_LT(score.shape, 0.25e-3);
  EXPECT_LT(score.z2, 1 + 3 * std::sqrt(2 / 36.0));
  EXPECT_GT(score.z2, 0.4);
  EXPECT_LT(score.largest_pull, 4);
}

TEST(CameraFit, FindsCamerasFromABoardAndCorners) {
  const Score score = scoreOf(12, 0, 8, 0.2);
  EXPECT_LT(score.rms, 0.5e-3);
  EXPECT_LT(score.z2, 1 + 3 * std::sqrt(2 / 36.0));
  EXPECT_GT(score.z2, 0.4);
  EXPECT_LT(score.largest_pull, 4);
}

TEST(CameraFit, IsExactWithoutNoise) {
  // Up to the unobservable unknowns: the principal point is in the middle, pixels are square.
  Random random(1);
  optics::CameraParameters camera = optics::simulatedCamera(kColumns, kRows, 1.2, 0.9);
  camera.cx = (kColumns - 1) / 2.0;
  camera.cy = (kRows - 1) / 2.0;
  camera.fy = camera.fx;
  camera.k2 = camera.p1 = camera.p2 = 0;
  const CameraObservations observations = observationsOf(camera, 300, {0, 0}, random);
  const CameraFit fit = fitCamera(observations);
  ASSERT_THAT(fit.refusal, IsEmpty());
  // The centre of a circle's ellipse is known to second order, to 1e-4 px.
  EXPECT_LT(trueError(fit, camera, observations).largest, 0.1e-3);
  EXPECT_NEAR(fit.height, optics::CameraModel(camera).centre()[2], 3e-3);
}

TEST(CameraFit, EstimatesTheNoiseOfTheCircles) {
  Random random(2);
  const optics::CameraParameters camera = someCamera(random, kColumns, kRows);
  const CameraFit fit = fitCamera(observationsOf(camera, 500, {0.05, 0.3}, random));
  ASSERT_THAT(fit.refusal, IsEmpty());
  EXPECT_NEAR(fit.cap_noise, 0.05, 0.006);
  EXPECT_NEAR(fit.spacing_residual, 0.05 * std::sqrt(2) * 0.00134, 0.02e-3);
}

TEST(CameraFit, ExcludesFalseDetections) {
  Random random(3);
  const optics::CameraParameters camera = someCamera(random, kColumns, kRows);
  CameraObservations observations = observationsOf(camera, 400, {0.02, 0.2}, random);
  for (std::size_t i = 0; i < 40; ++i) observations.caps[10 * i].big.x += 3 * random.normal();
  const CameraFit fit = fitCamera(observations);
  ASSERT_THAT(fit.refusal, IsEmpty());
  EXPECT_GT(fit.outlying, 25);
  EXPECT_LE(fit.outlying, 45);
  EXPECT_NEAR(fit.cap_noise, 0.02, 0.004);
  EXPECT_LT(trueError(fit, camera, observations).largest_pull, 4);
}

TEST(CameraFit, EstimatesFromTheCornersAlone) {
  Random random(4);
  const optics::CameraParameters camera = optics::simulatedCamera(kColumns, kRows, 1.2, 0.9);
  const CameraObservations observations = observationsOf(camera, 200, {0, 0.5}, random);
  const optics::CameraModel guess(guessFromCorners(observations, 1.72, -0.12));
  for (const CapObservation& observation : observations.caps) {
    const auto big = guess.toPlane(observation.big, observations.cap.height);
    const auto small = guess.toPlane(observation.small, observations.cap.height);
    ASSERT_TRUE(big && small);
    EXPECT_NEAR(std::hypot(big->x - small->x, big->y - small->y), observations.cap.spacing(),
                0.7e-3);
  }
}

class CameraFitRefusal : public testing::Test {
 protected:
  Random random_{5};
  optics::CameraParameters camera_ = someCamera(random_, kColumns, kRows);
  CameraObservations sights_ = observationsOf(camera_, 300, {}, random_);

  std::string refusal() { return fitCamera(sights_).refusal; }
};

TEST_F(CameraFitRefusal, IsEmptyForGoodObservations) { EXPECT_THAT(refusal(), IsEmpty()); }

TEST_F(CameraFitRefusal, TooFewCaps) {
  sights_.caps.resize(20);
  EXPECT_THAT(refusal(), HasSubstr("found 20 caps"));
}

TEST_F(CameraFitRefusal, OnePartOfTheArenaWithoutCaps) {
  std::erase_if(sights_.caps, [this](const CapObservation& observation) {
    const auto place = optics::CameraModel(camera_).toPlane(observation.big, 0.05);
    return place->x > 0.75 && place->y < 0.35;
  });
  EXPECT_THAT(refusal(), HasSubstr("found 0 caps in the corner of low y, high x"));
}

TEST_F(CameraFitRefusal, CornersInClockwiseOrder) {
  std::swap(sights_.corners[1], sights_.corners[3]);
  EXPECT_THAT(refusal(), HasSubstr("clockwise in the picture"));
}

TEST_F(CameraFitRefusal, CornersCrossed) {
  std::swap(sights_.corners[0], sights_.corners[1]);
  EXPECT_THAT(refusal(), HasSubstr("sides that cross"));
}

TEST_F(CameraFitRefusal, CornersThatStartAtAnotherCorner) {
  std::rotate(sights_.corners.begin(), sights_.corners.begin() + 1, sights_.corners.end());
  EXPECT_THAT(refusal(), HasSubstr("expected 1.33 : 1"));
}

TEST_F(CameraFitRefusal, CornersOutsideThePicture) {
  sights_.corners[2].x = 5000;
  EXPECT_THAT(refusal(), HasSubstr("corner 3: found 5000"));
}

TEST_F(CameraFitRefusal, ACornerThatIsBadlyMarked) {
  sights_.corners[2].x += 25;
  EXPECT_THAT(refusal(), HasSubstr("the corners differ from the fit by"));
}

TEST_F(CameraFitRefusal, CapsOfAnotherSpacing) {
  sights_.cap.big_offset += 0.003;
  EXPECT_THAT(refusal(), HasSubstr("the circles' spacing differs from 39.0 mm"));
}

TEST_F(CameraFitRefusal, CapsOfAnotherSpacingDetectedByTheCamerasHeight) {
  sights_.cap.big_offset += 0.0004;
  sights_.camera_height = optics::CameraModel(camera_).centre()[2];
  EXPECT_THAT(refusal(), testing::AnyOf(HasSubstr("the fitted height of the camera is"),
                                        HasSubstr("the caps' height and spacing right?")));
}

TEST_F(CameraFitRefusal, CirclesWithLargeErrors) {
  sights_.caps = capsSeen(camera_, 300, {0.3, 0, 0}, random_);
  EXPECT_THAT(refusal(), HasSubstr("the circles' spacing differs from 36.0 mm"));
}

TEST_F(CameraFitRefusal, FalseDetectionsOnly) {
  for (CapObservation& observation : sights_.caps) {
    observation.small = {observation.big.x + 60 * random_.uniform(),
                         observation.big.y + 60 * random_.uniform()};
  }
  EXPECT_THAT(refusal(), testing::Not(IsEmpty()));
}

TEST_F(CameraFitRefusal, CornersTooInaccurateForPositions) {
  sights_.corner_sigma = 4;
  EXPECT_THAT(refusal(), HasSubstr("the standard error of positions is"));
}

}  // namespace
}  // namespace lab::calibration
