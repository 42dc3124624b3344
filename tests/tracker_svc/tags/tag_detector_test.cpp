#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "light/optics/tag_pattern.hpp"
#include "tests/support/marker_scenes/marker_scene.hpp"
#include "tests/support/marker_scenes/marker_score.hpp"
#include "tracker_svc/marker_detector.hpp"

namespace lab::detector::tag_detector_test {
namespace {

using cases::fourSigmas;
using cases::MarkerKind;
using cases::MarkerScore;
using cases::TrueMarker;

std::unique_ptr<MarkerDetector> detectorOf(const MarkerKind& kind) {
  return makeTagDetector(
      cameraOf(kind.settings), {.gamma = 1},
      {.family = kind.settings.family, .size = 2 * kind.long_axis, .height = kind.settings.plane});
}

MarkerScore scoreOf(const std::string& name, int pictures) {
  const MarkerKind kind = cases::markerKind(name);
  return cases::scoreOf(kind, *detectorOf(kind), pictures);
}

class TagKinds : public testing::TestWithParam<const char*> {};

TEST_P(TagKinds, AreAllFoundWithTheirNumbers) {
  const MarkerScore score = scoreOf(GetParam(), 1);
  EXPECT_GE(score.recall(), 0.99) << score.text();
  EXPECT_EQ(score.wrong, 0) << score.text();
  EXPECT_EQ(score.ids, 0) << score.text();
}

INSTANTIATE_TEST_SUITE_P(Tags, TagKinds,
                         testing::Values("tags_clean", "tags_small", "tags_gradient", "tags_waves",
                                         "tags_dim", "tags_defocus", "tags_contact",
                                         "tags_standard41"));

TEST(TagDetector, SaysErrorsThatItHas) {
  for (const char* name : {"tags_clean", "tags_dim"}) {
    const MarkerScore score = scoreOf(name, 3);
    const double n = score.measured;
    EXPECT_NEAR(score.nees / n, 1, 0.3 + fourSigmas(3 * score.measured)) << name << score.text();
    EXPECT_NEAR(score.nees_theta / n, 1, 0.35 + fourSigmas(score.measured)) << name << score.text();
  }
}

TEST(TagDetector, HasTheHeadingOfItsRightEdge) {
  const MarkerKind kind = cases::markerKind("tags_clean");
  const double theta = 2.5;
  const std::vector<TrueMarker> truth{{0.5, 0.6, theta, 0.02, 0.02, 7, false}};
  const optics::GreyImage picture = paintMarkers(kind.settings, truth);

  const std::vector<Detection> found = detectorOf(kind)->search(picture.view());

  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].tag, 7);
  EXPECT_EQ(found[0].heading, HeadingKind::kDirected);
  EXPECT_NEAR(found[0].theta, theta, 0.002);
  EXPECT_NEAR(found[0].x, 0.5, 2e-5);
  EXPECT_NEAR(found[0].y, 0.6, 2e-5);
  EXPECT_NEAR(static_cast<double>(found[0].length), 0.04, 1e-4);
}

TEST(TagDetector, FollowsToThePosesOfTheSearch) {
  const MarkerKind kind = cases::markerKind("tags_clean");
  const std::vector<TrueMarker> truth = placeMarkers(kind, 3);
  const optics::GreyImage picture = paintMarkers(kind.settings, truth);
  const auto detector = detectorOf(kind);
  const std::vector<Detection> searched = detector->search(picture.view());
  std::vector<Expected> expected;
  for (const Detection& one : searched)
    expected.push_back({one.x + 0.002, one.y, one.theta, 0.01, 4});
  expected.push_back({0.02, 0.02, 0, 0.005, 4});

  const std::vector<Detection>& followed = detector->follow(picture.view(), expected);

  ASSERT_EQ(followed.size(), searched.size() + 1);
  EXPECT_EQ(followed.back().quality, 0.0F);
  for (std::size_t i = 0; i < searched.size(); ++i) {
    EXPECT_EQ(followed[i].tag, searched[i].tag);
    EXPECT_NEAR(followed[i].x, searched[i].x, 5e-6);
    EXPECT_NEAR(followed[i].y, searched[i].y, 5e-6);
  }
}

TEST(TagDetector, KeepsTheBetterOfTwoTagsWithOneNumber) {
  const MarkerKind kind = cases::markerKind("tags_clean");
  const std::vector<TrueMarker> truth{{0.4, 0.4, 0, 0.02, 0.02, 5, false},
                                      {0.7, 0.5, 1, 0.02, 0.02, 5, false}};
  const optics::GreyImage picture = paintMarkers(kind.settings, truth);
  std::vector<Rejection> rejected;

  const std::vector<Detection> found = detectorOf(kind)->search(picture.view(), &rejected);

  EXPECT_EQ(found.size(), 1U);
  ASSERT_EQ(rejected.size(), 1U);
  EXPECT_EQ(rejected[0].reason, Reason::kTaken);
}

TEST(TagDetector, FindsNothingInNoise) {
  const MarkerKind kind = cases::markerKind("tags_gradient");
  const optics::GreyImage picture = paintMarkers(kind.settings, {});
  EXPECT_THAT(detectorOf(kind)->search(picture.view()), testing::IsEmpty());
}

TEST(TagDetector, RefusesUnknownFamilies) {
  EXPECT_THROW(static_cast<void>(optics::TagFamily("tag99h9")), std::invalid_argument);
  for (const std::string& family : optics::tagFamilies())
    EXPECT_GT(optics::TagFamily(family).size(), 0) << family;
}

}  // namespace
}  // namespace lab::detector::tag_detector_test
