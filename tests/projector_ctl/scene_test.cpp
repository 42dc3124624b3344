#include "projector_ctl/scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "projector_ctl/projector_core.hpp"

namespace lab::projector::scene_test {
namespace {

using light::Drive;
using light::DrivenLayer;
using light::evaluate;
using light::Follow;
using light::Gate;
using light::Layer;
using light::LayerKind;
using light::WhenLost;
using testing::HasSubstr;

constexpr std::int64_t kStart = 1'000'000'000'000;  // [us]
constexpr double kClose = 1e-9;

std::int64_t at(double seconds) {
  return kStart + static_cast<std::int64_t>(std::llround(seconds * 1e6));
}

Layer disk(double x = 0, double y = 0) {
  return {.kind = LayerKind::kDisk, .x = x, .y = y, .size = 0.05, .intensity = 1};
}

DrivenLayer spot(Drive drive = {}) {
  drive.follow = Follow::kRobots;
  return {disk(), drive};
}

DrivenLayer trail() {
  Drive drive;
  drive.follow = Follow::kTrail;
  drive.rate = 5;
  return {disk(), drive};
}

/// Robots 1 and 2 of an experiment, with poses set by the tests.
class SceneTest : public testing::Test {
 protected:
  void make(std::vector<DrivenLayer> layers) {
    ASSERT_EQ(Scene::problem(layers, around), std::nullopt);
    dut = std::make_unique<Scene>(std::move(layers), at(0), around);
  }
  void see(double time, std::vector<ObservedRobot> seen) {
    const ObservedFrame frame{1, ++number, at(time), std::move(seen)};
    robots.add(frame);
    if (dut) dut->addFrame(frame, robots);
  }
  const std::vector<Layer>& layersAt(double time) {
    return dut->at({at(time), at(time)}, robots).layers;
  }
  const Scene::Picture& pictureAt(double time) { return dut->at({at(time), at(time)}, robots); }

  SceneContext around{.robots = {1, 2}, .programs = {"abp", "bp"}};
  RobotTracks robots{around.robots};
  std::unique_ptr<Scene> dut;
  std::int64_t number = 0;
};

TEST_F(SceneTest, PutsACopyUnderEachRobotInItsOwnFrame) {
  DrivenLayer ahead = spot();
  ahead.layer.x = 0.1;
  ahead.layer.y = 0.02;
  ahead.layer.angle = 0.5;
  make({ahead});
  see(1, {{1, 0.3, 0.4, 0}, {2, 0.6, 0.5, std::numbers::pi / 2}});
  const std::vector<Layer>& layers = layersAt(1);
  ASSERT_EQ(layers.size(), 2U);
  EXPECT_NEAR(layers[0].x, 0.4, kClose);
  EXPECT_NEAR(layers[0].y, 0.42, kClose);
  EXPECT_NEAR(layers[1].x, 0.58, kClose);
  EXPECT_NEAR(layers[1].y, 0.6, kClose);
  EXPECT_NEAR(layers[1].angle, 0.5 + std::numbers::pi / 2, kClose);
}

TEST_F(SceneTest, FollowsOnlyTheNamedRobots) {
  Drive drive;
  drive.robots = {2};
  make({spot(drive)});
  see(1, {{1, 0.3, 0.4, 0}, {2, 0.6, 0.5, 0}});
  ASSERT_EQ(layersAt(1).size(), 1U);
  EXPECT_NEAR(layersAt(1)[0].x, 0.6, kClose);
}

TEST_F(SceneTest, PredictsToTheTimeOfTheLightUnlessDisabled) {
  Drive plain;
  plain.predict = false;
  plain.robots = {1};
  Drive predicting;
  predicting.robots = {1};
  make({spot(predicting), spot(plain)});
  for (int i = 0; i <= 30; ++i) see(i / 60.0, {{1, 0.2 + 0.1 * i / 60, 0.4, 0}});
  const std::vector<Layer> layers = dut->at({at(0.51), at(0.55)}, robots).layers;
  EXPECT_NEAR(layers[0].x, 0.255, 1e-6);
  EXPECT_NEAR(layers[1].x, 0.25, kClose);
}

TEST_F(SceneTest, CountsTimeFromItsCommand) {
  Drive drive;
  drive.vx = 0.1;
  drive.waveform = light::Waveform::kSquare;
  drive.period = 2;
  make({{disk(0.2, 0.3), drive}});
  EXPECT_NEAR(layersAt(0.5)[0].x, 0.25, kClose);
  EXPECT_EQ(layersAt(0.5)[0].intensity, 1);
  EXPECT_EQ(layersAt(1.5)[0].intensity, 0);
}

TEST_F(SceneTest, RemovesHoldsOrGoesSafeWhenARobotIsLostAndReportsIt) {
  for (const WhenLost wanted : {WhenLost::kRemove, WhenLost::kHold, WhenLost::kSafe}) {
    Drive drive;
    drive.when_lost = wanted;
    drive.robots = {1};
    robots = RobotTracks(around.robots);
    make({spot(drive)});
    EXPECT_EQ(pictureAt(0.9).layers.size(), 0U);
    EXPECT_THAT(pictureAt(0.9).trouble, HasSubstr("robot 1 (not seen yet)"));
    for (int i = 0; i <= 6; ++i) see(1 + i / 60.0, {{1, 0.3 + 0.002 * i, 0.4, 0}});
    EXPECT_EQ(pictureAt(1.6).trouble, "");
    EXPECT_FALSE(pictureAt(1.6).safe);
    const Scene::Picture& lost = pictureAt(1.601);
    EXPECT_EQ(lost.safe, wanted == WhenLost::kSafe);
    EXPECT_EQ(lost.layers.size(), wanted == WhenLost::kHold ? 1U : 0U);
    if (wanted == WhenLost::kHold) {
      EXPECT_NEAR(lost.layers[0].x, 0.312, kClose);
    }
    // kStart is 1e6 s after 1970: 13:46:40.
    EXPECT_THAT(lost.trouble, HasSubstr("robot 1 (last seen 13:46:41.100 UTC)"));
    EXPECT_EQ(pictureAt(9).trouble, pictureAt(2).trouble) << "one text, not one per frame";
  }
}

TEST_F(SceneTest, GatesCopiesByTheProgramOfTheirRobot) {
  Drive drive;
  drive.gate = Gate::kProgram;
  drive.gate_program = "abp";
  make({spot(drive)});
  see(1, {{1, 0.3, 0.4, 0}, {2, 0.6, 0.5, 0}});
  EXPECT_EQ(layersAt(1).size(), 0U) << "no robot has reported its program";
  robots.report(1, "bp", at(1));
  robots.report(2, "abp", at(1));
  ASSERT_EQ(layersAt(1.1).size(), 1U);
  EXPECT_NEAR(layersAt(1.1)[0].x, 0.6, kClose);
}

TEST_F(SceneTest, GatesByPlaceForOneRobotOrForAny) {
  Drive any;
  any.gate = Gate::kInside;
  any.gate_x = 0.6;
  any.gate_y = 0.5;
  any.gate_radius = 0.1;
  Drive first = any;
  first.gate_robot = 1;
  Drive outside = first;
  outside.gate = Gate::kOutside;
  make({{disk(0.1, 0), any}, {disk(0.2, 0), first}, {disk(0.3, 0), outside}});
  EXPECT_EQ(layersAt(0.5).size(), 0U) << "a robot that is not seen is neither inside nor outside";
  see(1, {{1, 0.3, 0.4, 0}, {2, 0.6, 0.55, 0}});
  ASSERT_EQ(layersAt(1).size(), 2U);
  EXPECT_EQ(layersAt(1)[0].x, 0.1);
  EXPECT_EQ(layersAt(1)[1].x, 0.3);
  see(1.1, {{1, 0.6, 0.5, 0}});
  see(1.2, {{1, 0.6, 0.5, 0}});  // the second pose confirms the jump
  ASSERT_EQ(layersAt(1.2).size(), 2U);
  EXPECT_EQ(layersAt(1.2)[1].x, 0.2);
}

TEST_F(SceneTest, ATrailIsAGridOverTheArenaThatGrowsUnderFollowedRobots) {
  DrivenLayer wanted = trail();
  wanted.drive.robots = {1};
  make({wanted});
  for (int i = 0; i <= 60; ++i) see(i / 60.0, {{1, 0.3, 0.4, 0}, {2, 0.6, 0.5, 0}});
  ASSERT_EQ(layersAt(1).size(), 1U);
  const Layer grid = layersAt(1)[0];
  EXPECT_EQ(validate(grid), std::nullopt);
  EXPECT_EQ(grid.kind, LayerKind::kGrid);
  EXPECT_GT(evaluate({{grid}, {}, 1}, 0.3, 0.4), 0.9);
  EXPECT_EQ(evaluate({{grid}, {}, 1}, 0.6, 0.5), 0);
  EXPECT_EQ(static_cast<std::int64_t>(grid.seed), at(1));
}

TEST_F(SceneTest, ATrailStartsWithItsCommandAndHasNoSourceInGaps) {
  make({trail()});
  for (int i = -60; i <= 0; ++i) see(i / 60.0, {{1, 0.3, 0.4, 0}});
  EXPECT_EQ(evaluate({layersAt(0), {}, 1}, 0.3, 0.4), 0);
  see(3, {{1, 0.9, 0.4, 0}});
  see(3.01, {{1, 0.9, 0.4, 0}});
  EXPECT_EQ(evaluate({layersAt(3.01), {}, 1}, 0.6, 0.4), 0);
  EXPECT_GT(evaluate({layersAt(3.01), {}, 1}, 0.9, 0.4), 0);
}

TEST_F(SceneTest, ATrailIsLaidOnlyThroughAnOpenGate) {
  DrivenLayer wanted = trail();
  wanted.drive.gate = Gate::kInside;
  wanted.drive.gate_x = 0.3;
  wanted.drive.gate_y = 0.4;
  wanted.drive.gate_radius = 0.1;
  make({wanted});
  for (int i = 0; i <= 60; ++i) see(i / 60.0, {{1, 0.3, 0.4, 0}, {2, 0.8, 0.5, 0}});
  EXPECT_GT(evaluate({layersAt(1), {}, 1}, 0.3, 0.4), 0.9);
  EXPECT_EQ(evaluate({layersAt(1), {}, 1}, 0.8, 0.5), 0);
}

TEST_F(SceneTest, TwoTrailsShareTheCellsOfOne) {
  make({trail(), trail()});
  std::size_t bytes = 0;
  for (const Layer& layer : layersAt(1)) bytes += layer.pixels->grey.size();
  EXPECT_LE(bytes, 160U * 120U);
  EXPECT_LE(Scene::bytesOf(layersAt(1)), Scene::kMostBytes);
}

TEST_F(SceneTest, IsStillWithoutDrives) {
  make({{disk(0.1, 0.2), {}}});
  EXPECT_TRUE(dut->isStill());
  EXPECT_FALSE(dut->needsPoses());
  make({spot()});
  EXPECT_FALSE(dut->isStill());
  EXPECT_TRUE(dut->needsPoses());
}

TEST(SceneProblem, NamesLayerFieldAndWhatIsAllowed) {
  SceneContext around{.robots = {}, .programs = {"abp"}};
  for (int id = 1; id <= 20; ++id) around.robots.push_back(id);
  const auto problem = [&](const std::vector<DrivenLayer>& layers) {
    return Scene::problem(layers, around).value_or("");
  };
  EXPECT_EQ(problem(std::vector<DrivenLayer>(161)),
            "layers = more than 160 layers, allowed: at most 160");
  EXPECT_EQ(problem(std::vector<DrivenLayer>(7, spot())), "");
  EXPECT_EQ(problem(std::vector<DrivenLayer>(8, spot())),
            "layers = 160 layers with a copy for each robot followed, allowed: at most 159");
  DrivenLayer wrong = spot();
  wrong.drive.stale = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(problem({spot(), wrong}), HasSubstr("layers[1].stale = nan s, allowed: "));
  wrong = spot();
  wrong.drive.gate = Gate::kProgram;
  wrong.drive.gate_program = "rtp";
  EXPECT_THAT(problem({wrong}), HasSubstr("layers[0].gate_program = \"rtp\", allowed: a program"));
  wrong = trail();
  wrong.layer.kind = LayerKind::kChecker;
  EXPECT_THAT(problem({wrong}), HasSubstr("layers[0].follow = 2, allowed: "));
  wrong = {{.kind = LayerKind::kImage, .size = 1, .inner = 1, .intensity = 1}, {}};
  wrong.layer.image = std::string(64, 'a');
  wrong.layer.pixels =
      std::make_shared<light::Image>(light::Image{1, 1, {0}, std::string(64, 'a')});
  wrong.drive.images = {std::string(64, 'b')};
  EXPECT_THAT(problem({wrong}), HasSubstr("layers[0].images = bbbb"));
  std::vector<DrivenLayer> much(100, DrivenLayer{disk(), {}});
  EXPECT_EQ(problem(much), "");
  much.push_back(trail());
  EXPECT_THAT(problem(much), HasSubstr("bytes of LIGHT_STATUS, allowed: at most 29000"));
}

/// ProjectorCore with scenes that change by themselves.
class DrivenCore : public testing::Test {
 protected:
  LightCommand command(std::int64_t seq, std::vector<DrivenLayer> layers) {
    return {.sender = "lab",
            .instance = 7,
            .seq = seq,
            .hold_until_utime = at(1000),
            .layers = std::move(layers)};
  }
  static ProjectorCore::Config config() {
    ProjectorCore::Config result;
    result.safe_field = {Layer{.intensity = 0.05}};
    result.scene_context.robots = {1};
    return result;
  }
  static DrivenLayer moving(double speed) {
    Drive drive;
    drive.vx = speed;
    return {disk(0.2, 0.3), drive};
  }
  void see(double time, double x) { dut.addFrame({9, ++number, at(time), {{1, x, 0.4, 0}}}); }
  ProjectorCore dut{config()};
  std::int64_t number = 0;
};

TEST_F(DrivenCore, ResolvesBothFieldsOfACrossFadeInEveryFrame) {
  LightCommand first = command(1, {moving(0.1)});
  first.from_utime = at(0);
  EXPECT_EQ(dut.apply(first, at(0)).verdict, Verdict::kAccepted);
  LightCommand second = command(2, {moving(-0.1)});
  second.ramp = 1;
  second.from_utime = at(1);
  EXPECT_EQ(dut.apply(second, at(0.5)).verdict, Verdict::kAccepted);
  const ShownFrame& shown = dut.frame(at(1.5));
  ASSERT_EQ(shown.field.previous.size(), 1U);
  EXPECT_NEAR(shown.field.previous[0].x, 0.35, kClose);
  EXPECT_NEAR(shown.field.layers[0].x, 0.15, kClose);
  EXPECT_NEAR(shown.field.mix, 0.5, kClose);
  EXPECT_TRUE(shown.moving);
}

TEST_F(DrivenCore, FreezesAnInterruptedCrossFade) {
  LightCommand first = command(1, {moving(0.1)});
  first.ramp = 1;
  first.from_utime = at(0);
  EXPECT_EQ(dut.apply(first, at(0)).verdict, Verdict::kAccepted);
  LightCommand second = command(2, {moving(0)});
  second.ramp = 1;
  EXPECT_EQ(dut.apply(second, at(0.5)).verdict, Verdict::kAccepted);
  const std::vector<Layer> early = dut.frame(at(0.6)).field.previous;
  const std::vector<Layer> late = dut.frame(at(0.9)).field.previous;
  ASSERT_EQ(early.size(), 3U);
  EXPECT_NEAR(early[2].x, 0.25, kClose);
  EXPECT_EQ(early, late);
}

TEST_F(DrivenCore, KeepsAStaticScene) {
  EXPECT_EQ(dut.apply(command(1, {{disk(0.1, 0.1), {}}}), at(0)).verdict, Verdict::kAccepted);
  EXPECT_TRUE(dut.frame(at(0.1)).changed);
  for (int i = 2; i < 60; ++i) {
    see(0.1 * i, 0.2);
    const ShownFrame& shown = dut.frame(at(0.1 * i));
    EXPECT_FALSE(shown.changed);
    EXPECT_FALSE(shown.moving);
    EXPECT_EQ(shown.tracker_instance, 0);
    EXPECT_TRUE(shown.tracked_frames.empty());
  }
}

TEST_F(DrivenCore, CountsTimeFromTheStartOfALateCommand) {
  LightCommand late = command(1, {moving(0.1)});
  late.from_utime = at(1);
  EXPECT_EQ(dut.apply(late, at(3)).verdict, Verdict::kAccepted);
  EXPECT_NEAR(dut.frame(at(3)).field.layers[0].x, 0.4, kClose);
}

TEST_F(DrivenCore, ComputesTheFieldForTheTimeOfTheLight) {
  ProjectorCore::Config slow = config();
  slow.latency = 0.04;
  ProjectorCore core(slow);
  LightCommand wanted = command(1, {moving(0.1)});
  wanted.from_utime = at(0);
  EXPECT_EQ(core.apply(wanted, at(0)).verdict, Verdict::kAccepted);
  const ShownFrame& shown = core.frame(at(0.5));
  EXPECT_EQ(shown.presentation_utime, at(0.54));
  EXPECT_NEAR(shown.field.layers[0].x, 0.254, kClose);
}

TEST_F(DrivenCore, HasTracksWhenACommandBeginsToFollowRobots) {
  for (int i = 0; i <= 30; ++i) {
    see(i / 60.0, 0.2 + 0.1 * i / 60);
    dut.frame(at(i / 60.0 + 0.01));
  }
  EXPECT_EQ(dut.apply(command(1, {spot()}), at(0.52)).verdict, Verdict::kAccepted);
  const ShownFrame& shown = dut.frame(at(0.55));
  ASSERT_EQ(shown.field.layers.size(), 1U);
  EXPECT_NEAR(shown.field.layers[0].x, 0.255, 1e-5);
  EXPECT_EQ(shown.tracker_instance, 9);
  EXPECT_EQ(shown.tracked_frames.back(), 31);
  EXPECT_GT(shown.tracked_frames.size(), 5U);
  see(0.56, 0.256);
  EXPECT_THAT(dut.frame(at(0.57)).tracked_frames, testing::ElementsAre(32));
}

TEST_F(DrivenCore, ShowsTheSafeFieldWhileAFollowedRobotIsLost) {
  Drive drive;
  drive.when_lost = WhenLost::kSafe;
  EXPECT_EQ(dut.apply(command(1, {spot(drive)}), at(0)).verdict, Verdict::kAccepted);
  EXPECT_EQ(evaluate(dut.frame(at(0.1)).field, 0, 0), 0.05);
  EXPECT_THAT(dut.frame(at(0.1)).trouble, HasSubstr("safe field: lost robot 1"));
  see(0.1, 0.3);
  const ShownFrame& found = dut.frame(at(0.2));
  EXPECT_TRUE(found.changed);
  EXPECT_EQ(found.trouble, "");
  EXPECT_EQ(evaluate(found.field, 0, 0), 0);
  EXPECT_EQ(evaluate(found.field, 0.3, 0.4), 1);
}

TEST_F(DrivenCore, ATrailContinuesUnderAnotherCommand) {
  EXPECT_EQ(dut.apply(command(1, {trail()}), at(0)).verdict, Verdict::kAccepted);
  dut.frame(at(0));
  LightCommand other = command(1, {{Layer{.intensity = 0.5}, {}}});
  other.sender = "hand";
  other.priority = 10;
  other.hold_until_utime = at(1);
  EXPECT_EQ(dut.apply(other, at(0.1)).verdict, Verdict::kAccepted);
  for (int i = 0; i <= 60; ++i) {
    see(i / 60.0, 0.3);
    dut.frame(at(i / 60.0 + 0.005));
  }
  EXPECT_GT(evaluate(dut.frame(at(1.1)).field, 0.3, 0.4), 0.9);
}

TEST_F(DrivenCore, StaysBelowTheMessageLimitWhenCrossFadesOfTrailsAreInterrupted) {
  for (int step = 1; step <= 40; ++step) {
    LightCommand next = command(step, {trail(), {disk(0.1, 0.1), {}}});
    next.ramp = 1;
    const double now = 0.25 * step;
    EXPECT_EQ(dut.apply(next, at(now)).verdict, Verdict::kAccepted);
    see(now, 0.3);
    const ShownFrame& shown = dut.frame(at(now + 0.01));
    EXPECT_LE(Scene::bytesOf(shown.field.previous), Scene::kMostBytes);
    EXPECT_EQ(validate(shown.field.previous), std::nullopt);
  }
}

TEST_F(DrivenCore, TogglesTheSyncPatchWithEveryCommandAlsoDuringRamps) {
  ProjectorCore::Config with_patch = config();
  with_patch.sync_patch = 0.025;
  ProjectorCore core(with_patch);
  const auto patch = [&](const ShownFrame& shown) {
    EXPECT_EQ(validate(shown.field.layers), std::nullopt);
    EXPECT_EQ(evaluate(shown.field, 0.0249, 0.0249), shown.sync);
    EXPECT_EQ(evaluate(shown.field, 0.0251, 0.0249), evaluate(shown.field, 0.0375, 0.0375));
    return shown.sync;
  };
  EXPECT_EQ(patch(core.frame(at(0))), 1);
  LightCommand ramp = command(1, {{Layer{.intensity = 0.7}, {}}});
  ramp.ramp = 1;
  EXPECT_EQ(core.apply(ramp, at(0.1)).verdict, Verdict::kAccepted);
  EXPECT_EQ(patch(core.frame(at(0.2))), 0);
  EXPECT_EQ(patch(core.frame(at(0.6))), 0);
  EXPECT_EQ(patch(core.frame(at(1.2))), 1) << "it also toggles every half second";
  EXPECT_EQ(core.apply(command(2, {{Layer{.intensity = 0.2}, {}}}), at(1.3)).verdict,
            Verdict::kAccepted);
  EXPECT_EQ(patch(core.frame(at(1.4))), 0);
  EXPECT_FALSE(core.frame(at(1.5)).changed);
}

}  // namespace
}  // namespace lab::projector::scene_test
