#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/marker_scenes/marker_scene.hpp"
#include "tests/support/marker_scenes/marker_score.hpp"
#include "tracker_svc/marker_detector.hpp"

namespace lab::detector::blob_detector_test {
namespace {

using cases::fourSigmas;
using cases::MarkerKind;
using cases::MarkerScore;
using cases::TrueMarker;

std::unique_ptr<MarkerDetector> detectorOf(const MarkerKind& kind) {
  const double mean = std::sqrt(kind.long_axis * kind.short_axis);
  return makeBlobDetector(cameraOf(kind.settings), {.gamma = 1},
                          {.bright = kind.bright,
                           .smallest = 1.2 * mean,
                           .largest = 2.6 * mean,
                           .height = kind.settings.plane,
                           .arena_width = kind.settings.arena_width,
                           .arena_height = kind.settings.arena_height});
}

MarkerScore scoreOf(const std::string& name, int pictures) {
  const MarkerKind kind = cases::markerKind(name);
  return cases::scoreOf(kind, *detectorOf(kind), pictures);
}

class BlobKinds : public testing::TestWithParam<const char*> {};

TEST_P(BlobKinds, AreAllFound) {
  const MarkerScore score = scoreOf(GetParam(), 2);
  EXPECT_GE(score.recall(), 0.99) << score.text();
  EXPECT_GE(score.precision(), 0.99) << score.text();
}

INSTANTIATE_TEST_SUITE_P(Blobs, BlobKinds,
                         testing::Values("blobs_clean", "blobs_small", "blobs_bright",
                                         "blobs_gradient", "blobs_dim", "blobs_defocus",
                                         "blobs_contact", "blobs_animals",
                                         "blobs_animals_contact"));

TEST(BlobDetector, SaysErrorsThatItHas) {
  for (const char* name : {"blobs_clean", "blobs_gradient", "blobs_bright", "blobs_animals"}) {
    const MarkerScore score = scoreOf(name, 5);
    const double n = score.measured;
    const int degrees = score.headings > 0 ? 3 : 2;
    EXPECT_NEAR(score.nees / n, 1, 0.15 + fourSigmas(score.measured * degrees))
        << name << ": " << score.text();
    EXPECT_NEAR(score.nees_x / n, 1, 0.15 + fourSigmas(score.measured))
        << name << ": " << score.text();
    if (score.headings > 0) {
      EXPECT_NEAR(score.nees_theta / score.headings, 1, 0.3 + fourSigmas(score.headings))
          << name << ": " << score.text();
    }
  }
}

TEST(BlobDetector, SaysLargerErrorsOfBlobsInContact) {
  const MarkerScore score = scoreOf("blobs_contact", 4);
  EXPECT_GT(score.nees / score.measured, 0.5) << score.text();
  EXPECT_LT(score.nees / score.measured, 2) << score.text();
}

TEST(BlobDetector, KnowsTheAxisOfLongBlobsOnly) {
  MarkerKind kind = cases::markerKind("blobs_animals");
  const std::vector<TrueMarker> truth{{0.4, 0.4, 0.7, 0.012, 0.005, -1, false},
                                      {0.7, 0.5, 0, 0.008, 0.008, -1, false}};
  const optics::GreyImage picture = paintMarkers(kind.settings, truth);

  const std::vector<Detection> found = detectorOf(kind)->search(picture.view());

  ASSERT_EQ(found.size(), 2U);
  for (const Detection& one : found) {
    const bool is_long = one.x < 0.5;
    EXPECT_EQ(one.heading, is_long ? HeadingKind::kAxis : HeadingKind::kUnknown);
    if (!is_long) continue;
    EXPECT_NEAR(std::remainder(one.theta - 0.7, 3.14159265), 0, 0.02);
    EXPECT_NEAR(static_cast<double>(one.length), 0.024, 0.001);
    EXPECT_NEAR(static_cast<double>(one.width), 0.010, 0.001);
    EXPECT_NEAR(static_cast<double>(one.area), 3.1416 * 0.012 * 0.005, 1.5e-5);
  }
}

TEST(BlobDetector, SaysHowManyBlobsItCouldNotSplit) {
  // Nothing shows how large a single blob is, except the largest one that was asked for.
  const MarkerKind kind = cases::markerKind("blobs_clean");
  const std::vector<TrueMarker> truth{{0.592, 0.45, 0, 0.008, 0.008, -1, false},
                                      {0.608, 0.45, 0, 0.008, 0.008, -1, false}};
  const optics::GreyImage picture = paintMarkers(kind.settings, truth);
  std::vector<Rejection> rejected;

  const std::vector<Detection> found = detectorOf(kind)->search(picture.view(), &rejected);

  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].merged, 2);
  EXPECT_LT(found[0].quality, 0.5F);
  ASSERT_EQ(rejected.size(), 1U);
  EXPECT_EQ(rejected[0].reason, Reason::kMerged);
}

TEST(BlobDetector, FindsNothingInNoise) {
  MarkerKind kind = cases::markerKind("blobs_gradient");
  for (const bool bright : {false, true}) {
    kind.bright = bright;
    const optics::GreyImage picture = paintMarkers(kind.settings, {});
    EXPECT_THAT(detectorOf(kind)->search(picture.view()), testing::IsEmpty());
  }
}

TEST(BlobDetector, IgnoresPicturesOfAnotherSize) {
  const MarkerKind kind = cases::markerKind("blobs_clean");
  const optics::GreyImage picture(640, 480, 200);
  EXPECT_THAT(detectorOf(kind)->search(picture.view()), testing::IsEmpty());
  EXPECT_THAT(detectorOf(kind)->search({}), testing::IsEmpty());
}

TEST(BlobDetector, FollowsInTheOrderOfTheExpectedPlaces) {
  const MarkerKind kind = cases::markerKind("blobs_clean");
  const std::vector<TrueMarker> truth{{0.4, 0.4, 0, 0.008, 0.008, -1, false},
                                      {0.7, 0.5, 0, 0.008, 0.008, -1, false}};
  const optics::GreyImage picture = paintMarkers(kind.settings, truth);
  const std::vector<Expected> expected{
      {0.701, 0.5, 0, 0.01, 4}, {0.9, 0.2, 0, 0.01, 4}, {0.4, 0.401, 0, 0.01, 4}};

  const auto detector = detectorOf(kind);
  const std::vector<Detection>& found = detector->follow(picture.view(), expected);

  ASSERT_EQ(found.size(), 3U);
  EXPECT_NEAR(found[0].x, 0.7, 1e-4);
  EXPECT_EQ(found[1].quality, 0.0F);
  EXPECT_NEAR(found[2].x, 0.4, 1e-4);
}

}  // namespace
}  // namespace lab::detector::blob_detector_test
