#include "tracker_svc/response_finder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "tests/support/tracker_scenes/scenes.hpp"

namespace lab::detector::response_finder_test {
namespace {

using cases::Scene;
using cases::SceneKind;
using cases::SceneLight;
using testing::HasSubstr;

struct Seen {
  const char* name;
  SceneKind kind;
};

ResponseFinder finderOf(const Scene& scene) {
  const sim::PainterSettings& settings = scene.settings;
  return {optics::CameraModel(settings.camera), settings.cap, settings.imaging};
}

class ResponseOf : public testing::TestWithParam<Seen> {};

TEST_P(ResponseOf, IsDeterminedByOnePictureOfManyCaps) {
  const Scene scene = cases::sceneOf(GetParam().kind, 3);
  ResponseFinder finder = finderOf(scene);
  finder.examine(cases::paint(scene).view());
  ASSERT_TRUE(finder.gamma());
  EXPECT_EQ(*finder.gamma(), GetParam().kind.gamma);
}

INSTANTIATE_TEST_SUITE_P(
    Pictures, ResponseOf,
    testing::Values(Seen{"linear", {}},
                    Seen{"linear_half", {.shown = SceneLight::kHalf, .low = 0.12}},
                    Seen{"linear_worn", {.glares = 4, .jpeg = 50}}, Seen{"video", {.gamma = 2.2}},
                    Seen{"video_dim", {.high = 0.12, .gamma = 2.2}},
                    Seen{"video_half", {.shown = SceneLight::kHalf, .low = 0.05, .gamma = 2.2}},
                    Seen{"webcam", {.gamma = 2.2, .sharpened = 1, .jpeg = 75}},
                    Seen{"webcam_sharp", {.gamma = 2.2, .sharpened = 2, .jpeg = 75}},
                    Seen{"webcam_small", {.rows = 480, .gamma = 2.2, .sharpened = 1, .jpeg = 75}}),
    [](const auto& each) { return std::string(each.param.name); });

TEST(ResponseFinder, StaysOpenWithoutCapsOrInDimLightOnly) {
  for (const SceneKind& kind :
       {SceneKind{.robots = 0, .debris = 25, .floor_pairs = 5}, SceneKind{.high = 0.22}}) {
    const Scene scene = cases::sceneOf(kind, 1);
    ResponseFinder finder = finderOf(scene);
    finder.examine(cases::paint(scene).view());
    EXPECT_FALSE(finder.gamma());
    EXPECT_FALSE(finder.isSettled());
    EXPECT_EQ(finder.reason(), "no cap was bright enough to decide");
  }
}

TEST(ResponseFinder, CountsCapsInAnyLight) {
  for (const double gamma : {1.0, 2.2}) {
    const Scene dim = cases::sceneOf({.high = 0.05, .gamma = gamma}, 1);
    ResponseFinder finder = finderOf(dim);
    finder.examine(cases::paint(dim).view());
    EXPECT_EQ(finder.gamma(), gamma);
    EXPECT_FALSE(finder.isSettled());
    EXPECT_THAT(finder.reason(), HasSubstr(" places caps are found only with it"));
  }
}

TEST(ResponseFinder, IsSettledByManyPlacesInBrightLight) {
  const Scene many = cases::sceneOf({}, 1);
  ResponseFinder finder = finderOf(many);
  finder.examine(cases::paint(many).view());
  EXPECT_TRUE(finder.isSettled());

  const Scene few = cases::sceneOf({.robots = 4, .gamma = 2.2}, 1);
  ResponseFinder patient = finderOf(few);
  for (int i = 0; i < 5; ++i) patient.examine(cases::paint(few).view());
  EXPECT_EQ(patient.gamma(), optics::kVideoGamma);
  EXPECT_FALSE(patient.isSettled());
}

// Both assumptions find all caps, so the paint decides: 0.08^(1 / 1.6) and 0.08^(1 / 1.4).
TEST(ResponseFinder, UsesThePaintIfBothAssumptionsFindAllCaps) {
  for (const auto& [gamma, taken_for] : {std::pair{1.6, 2.2}, std::pair{1.4, 1.0}}) {
    const Scene scene = cases::sceneOf({.robots = 1, .gamma = gamma}, 1);
    ResponseFinder finder = finderOf(scene);
    finder.examine(cases::paint(scene).view());
    EXPECT_EQ(finder.gamma(), taken_for);
    EXPECT_THAT(finder.reason(), HasSubstr("black paint shows as 0."));
  }
}

// Haze over the whole cap makes black paint grey, as gamma encoding does. Either assumption may
// then fit better.
TEST(ResponseFinder, InHazeTakesTheAssumptionThatFindsMoreCaps) {
  for (const double haze : {0.1, 0.2}) {
    for (const SceneKind& kind :
         {SceneKind{.shown = SceneLight::kStripes, .low = 0.35, .size = 0.08, .brightness = 0.8},
          SceneKind{.high = 0.3}, SceneKind{.brightness = 0.8}}) {
      Scene scene = cases::sceneOf(kind, 1);
      scene.settings.glares = {{0.6, 0.45, 5, haze}};
      const optics::GreyImage picture = cases::paint(scene);
      ResponseFinder finder = finderOf(scene);
      finder.examine(picture.view());
      const sim::PainterSettings& settings = scene.settings;
      const auto found = [&](double gamma) {
        optics::Imaging imaging = settings.imaging;
        imaging.gamma = gamma;
        Detector detector(optics::CameraModel(settings.camera), settings.cap, imaging);
        return detector.search(picture.view()).size();
      };
      const double taken = finder.gamma().value_or(1);
      EXPECT_GE(found(taken) + 1, found(taken == 1 ? optics::kVideoGamma : 1))
          << haze << ' ' << finder.reason();
    }
  }
}

// A robot under a reflection gives a wrong first sample; the following places outweigh it.
TEST(ResponseFinder, IsNotMisledByOneReflection) {
  Scene scene = cases::sceneOf({.robots = 1, .rows = 480}, 1);
  const sim::PaintedRobot first = scene.robots[0];
  std::vector<optics::GreyImage> later;
  sim::CameraPainter painter(scene.settings);
  painter.setLight(scene.light);
  for (int i = 0; i < 12; ++i) {
    optics::GreyImage& picture = later.emplace_back(640, 480);
    const sim::PaintedRobot robot{0.1 + 0.08 * i, 0.45, 1, 0, 0, 0};
    painter.paint({&robot, 1}, i, picture.pixels);
  }
  for (const double strength : {0.15, 0.25, 0.4}) {
    scene.settings.glares = {{first.x, first.y, 0.06, strength}};
    ResponseFinder finder = finderOf(scene);
    const optics::GreyImage picture = cases::paint(scene);
    for (int i = 0; i < 3; ++i) finder.examine(picture.view());
    for (const optics::GreyImage& next : later) finder.examine(next.view());
    EXPECT_TRUE(finder.isSettled());
    EXPECT_EQ(finder.gamma(), 1) << strength;
  }
}

// A recording that starts in dim light, in which the encoding cannot be determined.
TEST(ResponseFinder, SamplesInBrighterLightReplaceThoseInDimLight) {
  Scene scene = cases::sceneOf({.gamma = 2.2}, 1);
  ResponseFinder finder = finderOf(scene);
  for (const double intensity : {0.03, 0.3, 1.0}) {
    scene.light.layers.front().intensity = intensity;
    finder.examine(cases::paint(scene).view());
  }
  EXPECT_EQ(finder.gamma(), optics::kVideoGamma);
  EXPECT_TRUE(finder.isSettled());
}

}  // namespace
}  // namespace lab::detector::response_finder_test
