#include "tracker_svc/response_finder.hpp"

#include <gtest/gtest.h>

#include "tests/tracker_svc/kinds/scenes.hpp"

namespace lab::tracker::response_finder_test {
namespace {

using cases::Kind;
using cases::Scene;
using cases::Shown;

struct Seen {
  const char* name;
  Kind kind;
};

ResponseFinder finderOf(const Scene& scene) {
  const sim::PainterSettings& settings = scene.settings;
  return {optics::CameraModel(settings.camera), settings.cap, settings.imaging};
}

class ResponseOf : public testing::TestWithParam<Seen> {};

TEST_P(ResponseOf, IsToldFromOnePictureOfManyCaps) {
  const Scene scene = cases::sceneOf(GetParam().kind, 3);
  ResponseFinder finder = finderOf(scene);
  finder.take(cases::paint(scene).view());
  ASSERT_TRUE(finder.gamma());
  EXPECT_EQ(*finder.gamma(), GetParam().kind.gamma);
}

INSTANTIATE_TEST_SUITE_P(
    Pictures, ResponseOf,
    testing::Values(Seen{"linear", {}}, Seen{"linear_half", {.shown = Shown::kHalf, .low = 0.12}},
                    Seen{"linear_worn", {.glares = 4, .jpeg = 50}}, Seen{"video", {.gamma = 2.2}},
                    Seen{"video_dim", {.high = 0.12, .gamma = 2.2}},
                    Seen{"video_half", {.shown = Shown::kHalf, .low = 0.05, .gamma = 2.2}},
                    Seen{"webcam", {.gamma = 2.2, .sharpened = 1, .jpeg = 75}},
                    Seen{"webcam_small", {.rows = 480, .gamma = 2.2, .sharpened = 1, .jpeg = 75}}),
    [](const auto& each) { return std::string(each.param.name); });

TEST(ResponseFinder, SaysNothingWithoutCapsOrInLittleLight) {
  for (const Kind& kind : {Kind{.robots = 0, .debris = 25, .floor_pairs = 5}, Kind{.high = 0.12}}) {
    const Scene scene = cases::sceneOf(kind, 1);
    ResponseFinder finder = finderOf(scene);
    finder.take(cases::paint(scene).view());
    EXPECT_FALSE(finder.gamma());
    EXPECT_FALSE(finder.isSettled());
    EXPECT_EQ(finder.ratio(), 0);
  }
}

TEST(ResponseFinder, IsSettledByManyPlacesInMuchLight) {
  const Scene many = cases::sceneOf({.gamma = 2.2}, 1);
  ResponseFinder finder = finderOf(many);
  finder.take(cases::paint(many).view());
  EXPECT_TRUE(finder.isSettled());
  // Black paint of 0.08: 0.08^(1 / 2.2).
  EXPECT_NEAR(finder.ratio(), 0.317, 0.01);

  const Scene few = cases::sceneOf({.robots = 4, .gamma = 2.2}, 1);
  ResponseFinder patient = finderOf(few);
  for (int i = 0; i < 5; ++i) patient.take(cases::paint(few).view());
  EXPECT_EQ(patient.gamma(), optics::kVideoGamma);
  EXPECT_FALSE(patient.isSettled());

  const Scene dim = cases::sceneOf({.high = 0.12, .gamma = 2.2}, 1);
  ResponseFinder careful = finderOf(dim);
  careful.take(cases::paint(dim).view());
  EXPECT_EQ(careful.gamma(), optics::kVideoGamma);
  EXPECT_FALSE(careful.isSettled());
}

// Whatever a robot that begins under a lamp's reflection looks like, the next places say more.
TEST(ResponseFinder, IsNotMisledByOneReflection) {
  Scene scene = cases::sceneOf({.robots = 1}, 1);
  const sim::PainterSettings plain = scene.settings;
  for (const double strength : {0.15, 0.25, 0.4}) {
    scene.settings = plain;
    scene.settings.glares = {{scene.robots[0].x, scene.robots[0].y, 0.06, strength}};
    ResponseFinder finder = finderOf(scene);
    for (int i = 0; i < 3; ++i) finder.take(cases::paint(scene).view());
    scene.settings = plain;
    Scene moved = scene;
    for (int i = 0; i < 12; ++i) {
      moved.robots[0].x = 0.1 + 0.08 * i;
      moved.robots[0].y = 0.45;
      finder.take(cases::paint(moved).view());
    }
    EXPECT_TRUE(finder.isSettled());
    EXPECT_EQ(finder.gamma(), 1) << strength;
  }
}

// A film that begins in little light, in which the encoding cannot be told.
TEST(ResponseFinder, BelievesWhatComesInMoreLight) {
  Scene scene = cases::sceneOf({.gamma = 2.2}, 1);
  ResponseFinder finder = finderOf(scene);
  for (const double intensity : {0.03, 0.3, 1.0}) {
    scene.light.layers.front().intensity = intensity;
    finder.take(cases::paint(scene).view());
  }
  EXPECT_EQ(finder.gamma(), optics::kVideoGamma);
  EXPECT_TRUE(finder.isSettled());
}

}  // namespace
}  // namespace lab::tracker::response_finder_test
