#include "runner/script/script_player.hpp"

#include <gmock/gmock.h>

#include <cstdint>
#include <lab/light_command_t.hpp>
#include <map>
#include <utility>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/loop/loop.hpp"
#include "common/service/node.hpp"
#include "runner/script/light_controller.hpp"

namespace lab::runner::script_player_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::int64_t kStart = 5'000'000;

std::int64_t at(double seconds) { return kStart + static_cast<std::int64_t>(seconds * 1e6 + 0.5); }

LightStep planned(double begin) {
  LightStep step;
  step.at = begin;
  return step;
}

LightStep held(const char* label, double hold) {
  LightStep step;
  step.label = label;
  step.hold = hold;
  return step;
}

/// A step that waits for a robot within 10 cm of the corner.
LightStep corner(const char* label, double limit, IfNot if_not = IfNot::kNext) {
  LightStep step = held(label, limit);
  step.until.region = Region::kCircle;
  step.until.radius = 0.1;
  step.if_not = if_not;
  return step;
}

LightStep back(LightStep step, const char* to, std::int64_t times) {
  step.back_to = to;
  step.times = times;
  return step;
}

Experiment experimentOf(std::vector<LightStep> steps, double duration, bool repeat = false,
                        double length = 0) {
  Experiment experiment;
  experiment.duration = duration;
  experiment.robots.resize(1);
  experiment.robots[0].id = 1;
  experiment.light.steps = std::move(steps);
  experiment.light.repeat = repeat;
  experiment.light.length = length;
  return experiment;
}

tracked_frame_t frameAt(double seconds, double x) {
  tracked_frame_t frame{};
  frame.utime = at(seconds);
  frame.robots.resize(1);
  frame.robots[0].robot_id = 1;
  frame.robots[0].x = x;
  frame.num_robots = 1;
  return frame;
}

/// Plays to the end at the exact due times. @return time and index of every step; 99 for the end
std::vector<std::pair<double, std::size_t>> playedSteps(const Experiment& experiment) {
  ScriptPlayer player(experiment);
  player.begin(kStart);
  std::vector<std::pair<double, std::size_t>> shown;
  while (const auto due = player.due()) {
    EXPECT_FALSE(player.nextTransition(*due - 1).has_value());
    const auto transition = player.nextTransition(*due);
    if (!transition) {
      ADD_FAILURE() << "no transition when it was due";
      break;
    }
    if (transition->kind != ScriptTransition::Kind::kStep) {
      shown.emplace_back(static_cast<double>(*due - kStart) * 1e-6, 99);
      continue;
    }
    EXPECT_EQ(transition->number, static_cast<int>(shown.size()));
    shown.emplace_back(static_cast<double>(*due - kStart) * 1e-6, transition->index);
  }
  return shown;
}

TEST(ScriptPlayer, ShowsAPlannedScriptOnceAndKeepsItsLastStepToTheEnd) {
  EXPECT_THAT(playedSteps(experimentOf({planned(0), planned(2)}, 100)),
              ElementsAre(std::pair(0.0, 0U), std::pair(2.0, 1U), std::pair(100.0, 99U)));
}

TEST(ScriptPlayer, RepeatsAPlannedScriptUntilTheRunEnds) {
  EXPECT_THAT(playedSteps(experimentOf({planned(0), planned(2)}, 12, true, 5)),
              ElementsAre(std::pair(0.0, 0U), std::pair(2.0, 1U), std::pair(5.0, 0U),
                          std::pair(7.0, 1U), std::pair(10.0, 0U), std::pair(12.0, 99U)));
}

TEST(ScriptPlayer, ManyPassesAddNoRoundingError) {
  const auto shown = playedSteps(experimentOf({planned(0)}, 700, true, 1.0 / 3));
  ASSERT_GT(shown.size(), 2000U);
  EXPECT_NEAR(shown[1800].first, 600, 1e-9);
}

TEST(ScriptPlayer, RepeatsAGroupAndEndsTheRunWithTheLastStep) {
  EXPECT_THAT(
      playedSteps(
          experimentOf({held("a", 1), held("b", 2), back(held("c", 3), "b", 2), held("d", 1)}, 20)),
      ElementsAre(std::pair(0.0, 0U), std::pair(1.0, 1U), std::pair(3.0, 2U), std::pair(6.0, 1U),
                  std::pair(8.0, 2U), std::pair(11.0, 3U), std::pair(12.0, 99U)));
}

TEST(ScriptPlayer, PlaysNestedGroupsAndARepeatedStep) {
  const auto shown = playedSteps(
      experimentOf({held("a", 1), back(held("b", 1), "b", 2), back(held("c", 1), "a", 2)}, 100));
  std::vector<std::size_t> order;
  for (const auto& [when, index] : shown) order.push_back(index);
  EXPECT_THAT(order, ElementsAre(0U, 1U, 1U, 2U, 0U, 1U, 1U, 2U, 99U));
}

TEST(ScriptPlayer, AGroupRestartsInEveryPass) {
  const auto shown = playedSteps(experimentOf({back(held("a", 1), "a", 3)}, 7, true, 3));
  EXPECT_EQ(shown.size(), 8U);  // seven steps and the end
}

TEST(ScriptPlayer, GoesOnAtOnceWhenTheConditionIsMetAndReportsTheSample) {
  const Experiment experiment = experimentOf({corner("go", 30), held("then", 5)}, 100);
  ScriptPlayer player(experiment);
  player.begin(kStart);
  ASSERT_TRUE(player.nextTransition(at(0)));
  player.take(frameAt(1, 0.5));
  EXPECT_EQ(player.nextTransition(at(1.02)), std::nullopt);
  player.take(frameAt(2, 0.05));
  const auto transition = player.nextTransition(at(2.02));
  ASSERT_TRUE(transition);
  EXPECT_EQ(transition->kind, ScriptTransition::Kind::kStep);
  EXPECT_EQ(transition->index, 1U);
  EXPECT_EQ(
      transition->ended_by,
      "a robot is in the circle of radius 10 cm around 0, 0 cm; sample " + std::to_string(at(2)));
  EXPECT_EQ(transition->fault, "");
  EXPECT_EQ(player.nextTransition(at(2.02)), std::nullopt);
}

TEST(ScriptPlayer, IgnoresSamplesBeforeTheStep) {
  const Experiment experiment =
      experimentOf({corner("go", 30), corner("again", 30), held("then", 5)}, 100);
  ScriptPlayer player(experiment);
  player.begin(kStart);
  ASSERT_TRUE(player.nextTransition(at(0)));
  player.take(frameAt(2, 0.05));
  ASSERT_TRUE(player.nextTransition(at(2.02)));
  player.take(frameAt(2.01, 0.05));
  EXPECT_EQ(player.nextTransition(at(2.03)), std::nullopt);
  player.take(frameAt(2.03, 0.05));
  EXPECT_TRUE(player.nextTransition(at(2.05)));
}

TEST(ScriptPlayer, AnUnmetConditionIsAFault) {
  for (const auto& [if_not, kind] : {std::pair(IfNot::kNext, ScriptTransition::Kind::kStep),
                                     std::pair(IfNot::kEnd, ScriptTransition::Kind::kEnd),
                                     std::pair(IfNot::kSafe, ScriptTransition::Kind::kSafe)}) {
    const Experiment experiment = experimentOf({corner("go", 30, if_not), held("then", 5)}, 100);
    ScriptPlayer player(experiment);
    player.begin(kStart);
    ASSERT_TRUE(player.nextTransition(at(0)));
    player.take(frameAt(1, 0.5));
    EXPECT_EQ(player.nextTransition(at(29.999)), std::nullopt);
    const auto transition = player.nextTransition(at(30));
    ASSERT_TRUE(transition);
    EXPECT_EQ(transition->kind, kind);
    EXPECT_THAT(transition->fault,
                HasSubstr("step 0 \"go\": after 30 s its condition \"a robot is in"));
    EXPECT_THAT(transition->fault, HasSubstr("robot 1 came nearest, to 40.0 cm"));
    EXPECT_THAT(transition->ended_by, HasSubstr("its limit of 30 s"));
    EXPECT_EQ(player.due().has_value(), if_not == IfNot::kNext);
    EXPECT_EQ(player.nextTransition(at(31)), std::nullopt);
  }
}

TEST(ScriptPlayer, TheLastStepsConditionEndsTheRun) {
  const Experiment experiment = experimentOf({corner("go", 30)}, 30);
  ScriptPlayer player(experiment);
  player.begin(kStart);
  ASSERT_TRUE(player.nextTransition(at(0)));
  player.take(frameAt(3, 0));
  const auto transition = player.nextTransition(at(3));
  ASSERT_TRUE(transition);
  EXPECT_EQ(transition->kind, ScriptTransition::Kind::kOver);
  EXPECT_THAT(transition->ended_by, HasSubstr("sample"));
}

TEST(ScriptPlayer, AnUnmetConditionAtTheEndOfTheRunIsAFault) {
  const Experiment experiment = experimentOf({corner("go", 30, IfNot::kSafe)}, 30);
  ScriptPlayer player(experiment);
  player.begin(kStart);
  ASSERT_TRUE(player.nextTransition(at(0)));
  const auto transition = player.nextTransition(at(30));
  ASSERT_TRUE(transition);
  EXPECT_EQ(transition->kind, ScriptTransition::Kind::kSafe);
  EXPECT_THAT(transition->fault, HasSubstr("no robot was seen"));
}

TEST(ScriptPlayer, DelaysOfCallsDoNotAccumulate) {
  const Experiment experiment =
      experimentOf({held("a", 1), back(held("b", 1), "a", 3), held("c", 1)}, 100);
  ScriptPlayer player(experiment);
  player.begin(kStart);
  double now = 0;
  while (player.due() && *player.due() < at(100)) {
    now = static_cast<double>(*player.due() - kStart) * 1e-6 + 0.01;  // each 10 ms late
    ASSERT_TRUE(player.nextTransition(at(now)));
  }
  EXPECT_NEAR(now, 7.01, 1e-9);
}

TEST(ScriptPlayer, TheEndOfTheRunEndsARepeatedScriptWithoutAFault) {
  const Experiment experiment = experimentOf({corner("go", 30, IfNot::kEnd)}, 10, true, 30);
  ScriptPlayer player(experiment);
  player.begin(kStart);
  ASSERT_TRUE(player.nextTransition(at(0)));
  const auto transition = player.nextTransition(at(10));
  ASSERT_TRUE(transition);
  EXPECT_EQ(transition->kind, ScriptTransition::Kind::kOver);
  EXPECT_EQ(transition->fault, "");
}

/// A loop whose time the test sets, as after a suspension of the machine.
class LateLoop : public Loop {
 public:
  [[nodiscard]] std::int64_t now() const override { return now_; }
  [[nodiscard]] bool isVirtual() const override { return false; }
  void at(std::int64_t utime, Callback callback) override {
    waiting_.emplace(utime, std::move(callback));
  }
  void every(std::int64_t /*period_us*/, std::int64_t /*first_utime*/,
             Callback /*callback*/) override {}
  void stop() override {}

  void setTime(std::int64_t utime) { now_ = utime; }

  /// Calls what is due now, but not what that schedules.
  /// @return whether anything was due
  bool turn() {
    std::multimap<std::int64_t, Callback> due;
    while (!waiting_.empty() && waiting_.begin()->first <= now_) {
      due.insert(waiting_.extract(waiting_.begin()));
    }
    for (const auto& [utime, callback] : due) callback();
    return !due.empty();
  }

 private:
  std::int64_t now_ = kStart;
  std::multimap<std::int64_t, Callback> waiting_;
};

TEST(LightController, ReturnsToTheLoopWhileManyStepsAreDue) {
  const Experiment experiment = experimentOf({planned(0)}, 3600, true, 0.01);
  LateLoop loop;
  MemoryBus bus{[&loop] { return loop.now(); }};
  Node node(bus, loop, {"lab", 0, 1});
  int shown = 0;
  LightController dut(node, loop, experiment, {},
                      {.record = [](const auto&) {},
                       .fault = [](const auto&) {},
                       .shown = [] {},
                       .began = [&shown] { ++shown; },
                       .chosen_by_light = [] { return false; },
                       .end = [](const auto&) {}});
  dut.startScript();
  ASSERT_TRUE(loop.turn());
  ASSERT_EQ(shown, 1);

  loop.setTime(at(20));
  int before = shown;
  while (loop.turn()) {
    EXPECT_LE(shown - before, 200) << "in one turn of the loop";
    before = shown;
    bus.deliver();
  }

  EXPECT_EQ(shown, 2001);
  loop.setTime(at(20.01));
  while (loop.turn()) bus.deliver();
  EXPECT_EQ(shown, 2002) << "the timer of the next step";
}

}  // namespace
}  // namespace lab::runner::script_player_test
