#include "projector_ctl/projector_core.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>

namespace lab::projector {
namespace {

using light::DrivenLayer;
using light::Layer;
using light::LayerKind;
using testing::HasSubstr;

constexpr std::int64_t kStart = 1'000'000'000'000;  // [us]
constexpr std::int64_t kSecond = 1'000'000;         // [us]
constexpr double kExact = 1e-12;
constexpr double kSafe = 0.05;

std::vector<Layer> uniform(double intensity) { return {Layer{.intensity = intensity}}; }

std::vector<Layer> halfPlane(double intensity, double x) {
  return {Layer{.kind = LayerKind::kHalfPlane, .x = x, .intensity = intensity}};
}

std::vector<DrivenLayer> still(const std::vector<Layer>& layers) {
  std::vector<DrivenLayer> result;
  for (const Layer& layer : layers) result.push_back({layer, {}});
  return result;
}

LightCommand script(std::int64_t seq, double intensity) {
  return {.sender = "lab", .instance = 7, .seq = seq, .layers = still(uniform(intensity))};
}

LightCommand manual(std::int64_t seq, double intensity) {
  LightCommand command = script(seq, intensity);
  command.sender = "hand";
  command.priority = 10;
  return command;
}

/// The first command of a sender that no lab has.
LightCommand stranger(int number) {
  LightCommand command = script(1, 0.9);
  command.sender = "stranger " + std::to_string(number);
  return command;
}

class ProjectorCoreTest : public testing::Test {
 protected:
  /// All times below are in seconds after kStart.
  static std::int64_t at(double seconds) {
    return kStart + static_cast<std::int64_t>(seconds * 1e6 + 0.5);
  }
  Verdict give(const LightCommand& command, double seconds) {
    return dut.apply(command, at(seconds)).verdict;
  }
  double shownAt(double seconds) { return evaluate(dut.frame(at(seconds)).field, 0.3, 0.3); }

  ProjectorCore dut{{uniform(kSafe), 2.5, {}}};
};

using ProjectorCoreRamp = ProjectorCoreTest;
using ProjectorCorePriority = ProjectorCoreTest;
using ProjectorCoreSilence = ProjectorCoreTest;
using ProjectorCoreOrder = ProjectorCoreTest;
using ProjectorCoreRefusal = ProjectorCoreTest;
using ProjectorCoreSenders = ProjectorCoreTest;

TEST_F(ProjectorCoreTest, ShowsTheSafeFieldBeforeAnyCommand) {
  const ShownFrame& shown = dut.frame(at(0));
  EXPECT_EQ(evaluate(shown.field, 0, 0), kSafe);
  EXPECT_EQ(shown.commander, "");
  EXPECT_EQ(shown.label, "safe field: no command yet");
  EXPECT_EQ(shown.frame, 1);
  EXPECT_EQ(shown.first_shown_utime, at(0));
}

TEST_F(ProjectorCoreTest, ShowsACommandFromTheNextFrameOnAndEchoesIt) {
  dut.frame(at(0));
  LightCommand command = script(3, 0.6);
  command.label = "bright";
  EXPECT_EQ(give(command, 0.010), Verdict::kAccepted);

  const ShownFrame& shown = dut.frame(at(0.016667));
  EXPECT_EQ(evaluate(shown.field, 0, 0), 0.6);
  EXPECT_TRUE(shown.changed);
  EXPECT_FALSE(shown.moving);
  EXPECT_EQ(shown.commander, "lab");
  EXPECT_EQ(shown.instance, 7);
  EXPECT_EQ(shown.seq, 3);
  EXPECT_EQ(shown.label, "bright");
  EXPECT_EQ(shown.presentation_utime, at(0.016667));
  EXPECT_EQ(shown.first_shown_utime, at(0.016667));
}

TEST_F(ProjectorCoreTest, ReportsAChangeOnceAndKeepsTheTimeOfTheFirstFrame) {
  dut.frame(at(0));
  EXPECT_FALSE(dut.frame(at(0.1)).changed);
  give(script(1, 0.6), 0.11);
  EXPECT_TRUE(dut.frame(at(0.2)).changed);
  const ShownFrame& later = dut.frame(at(0.3));
  EXPECT_FALSE(later.changed);
  EXPECT_EQ(later.first_shown_utime, at(0.2));
  EXPECT_EQ(later.frame, 4);
}

TEST_F(ProjectorCoreTest, ShowsACommandFromItsStartTimeOn) {
  give(script(1, 0.2), 0);
  LightCommand later = script(2, 0.8);
  later.from_utime = at(1);
  EXPECT_EQ(give(later, 0.1), Verdict::kAccepted);
  EXPECT_EQ(shownAt(0.999), 0.2);
  EXPECT_EQ(shownAt(1.0), 0.8);
  EXPECT_EQ(dut.frame(at(1.1)).first_shown_utime, at(1.0));
}

TEST_F(ProjectorCoreTest, KeepsSeveralScheduledCommands) {
  for (int step = 1; step <= 3; ++step) {
    LightCommand command = script(step, 0.2 * step);
    command.from_utime = at(0.5 * step);
    give(command, 0);
  }
  EXPECT_EQ(shownAt(0.4), kSafe);
  EXPECT_NEAR(shownAt(0.5), 0.2, kExact);
  EXPECT_NEAR(shownAt(1.2), 0.4, kExact);
  EXPECT_NEAR(shownAt(1.5), 0.6, kExact);
}

TEST_F(ProjectorCoreTest, ANewerCommandReplacesCommandsScheduledForLater) {
  LightCommand planned = script(1, 0.2);
  planned.from_utime = at(1);
  give(planned, 0);
  give(script(2, 0.7), 0.1);
  EXPECT_EQ(shownAt(0.2), 0.7);
  EXPECT_EQ(shownAt(1.1), 0.7);
}

TEST_F(ProjectorCoreRamp, FadesLinearlyInTime) {
  give(script(1, 0.2), 0);
  shownAt(0.5);
  LightCommand command = script(2, 0.8);
  command.ramp = 2;
  command.from_utime = at(1);
  give(command, 0.6);
  EXPECT_NEAR(shownAt(1.0), 0.2, kExact);
  EXPECT_TRUE(dut.frame(at(1.0)).moving);
  EXPECT_NEAR(shownAt(1.5), 0.35, kExact);
  EXPECT_NEAR(shownAt(2.0), 0.5, kExact);
  EXPECT_NEAR(shownAt(3.0), 0.8, kExact);
  const ShownFrame& over = dut.frame(at(3.05));
  EXPECT_FALSE(over.moving);
  EXPECT_FALSE(over.changed);
  EXPECT_TRUE(over.field.previous.empty());
}

TEST_F(ProjectorCoreRamp, IsMovingUntilItsLastFrameWhichIsStillAChange) {
  LightCommand command = script(1, 0.8);
  command.ramp = 1;
  give(command, 0);
  EXPECT_TRUE(dut.frame(at(0.9)).moving);
  const ShownFrame& last = dut.frame(at(1.0));
  EXPECT_TRUE(last.changed);
  EXPECT_FALSE(last.moving);
}

TEST_F(ProjectorCoreRamp, DoesNotDependOnTheTimesOfFrames) {
  ProjectorCore other{{uniform(kSafe), 2.5, {}}};
  LightCommand command = script(1, 0.8);
  command.ramp = 1;
  ASSERT_EQ(dut.apply(command, at(0.003)).verdict, Verdict::kAccepted);
  ASSERT_EQ(other.apply(command, at(0.003)).verdict, Verdict::kAccepted);
  for (double t = 0.01; t < 0.6; t += 0.013) dut.frame(at(t));
  EXPECT_EQ(dut.frame(at(0.7)).field, other.frame(at(0.7)).field);
}

TEST_F(ProjectorCoreRamp, StartsAtTheArrivalOfALateCommand) {
  LightCommand command = script(1, 1);
  command.ramp = 1;
  command.from_utime = at(0.5);
  give(command, 1.0);
  EXPECT_NEAR(shownAt(1.5), 0.5 * kSafe + 0.5, kExact);
}

TEST_F(ProjectorCoreRamp, InterruptedContinuesFromTheFieldShown) {
  LightCommand first = script(1, 0);
  first.layers = still(halfPlane(1.0, 0.2));
  first.ramp = 1;
  give(first, 0);
  LightCommand second = script(2, 0);
  second.layers = still(halfPlane(0.6, 0.6));
  second.ramp = 1;
  give(second, 0.5);
  const double before = 0.5 * kSafe + 0.5 * 1.0;  // at x = 0.3, which only the first command lights
  EXPECT_NEAR(shownAt(0.5), before, kExact);
  EXPECT_NEAR(shownAt(0.75), 0.75 * before, kExact);
  EXPECT_NEAR(shownAt(1.5), 0, kExact);
}

TEST_F(ProjectorCoreRamp, InterruptedManyTimesStaysContinuousAndBounded) {
  for (int step = 1; step <= 200; ++step) {
    LightCommand command = script(step, 0);
    command.layers = still(halfPlane(step % 2 == 0 ? 1.0 : 0.2, 0.1));
    command.ramp = 1;
    const double now = 0.5 * step;
    const double before = shownAt(now);
    give(command, now);
    EXPECT_NEAR(shownAt(now), before, 1e-6) << "step " << step;
    EXPECT_LE(dut.frame(at(now)).field.previous.size(), light::kMostLayers);
  }
}

TEST_F(ProjectorCoreRamp, BetweenUniformFieldsStaysOneLayerHoweverOftenInterrupted) {
  for (int step = 1; step <= 50; ++step) {
    LightCommand command = script(step, step % 2 == 0 ? 1.0 : 0.2);
    command.ramp = 1;
    give(command, 0.1 * step);
  }
  EXPECT_EQ(dut.frame(at(5.05)).field.previous.size(), 1);
}

TEST_F(ProjectorCorePriority, TheHighestPriorityControlsTheLight) {
  give(script(1, 0.2), 0);
  give(manual(1, 0.9), 0.1);
  EXPECT_EQ(shownAt(0.2), 0.9);
  give(script(2, 0.4), 0.3);
  EXPECT_EQ(shownAt(0.4), 0.9);
  EXPECT_EQ(dut.frame(at(0.5)).commander, "hand");
}

TEST_F(ProjectorCorePriority, ReturnsToTheLatestCommandOfTheScriptAfterARelease) {
  give(script(1, 0.2), 0);
  give(manual(1, 0.9), 0.1);
  give(script(2, 0.4), 0.3);
  LightCommand release = manual(2, 0);
  release.release = true;
  EXPECT_EQ(give(release, 0.5), Verdict::kAccepted);
  EXPECT_EQ(shownAt(0.6), 0.4);
  EXPECT_EQ(dut.frame(at(0.7)).commander, "lab");
}

TEST_F(ProjectorCorePriority, ReturnsWithTheRampOfTheRelease) {
  give(script(1, 0.2), 0);
  give(manual(1, 1.0), 0.1);
  LightCommand release = manual(2, 0);
  release.release = true;
  release.ramp = 1;
  give(release, 1);
  EXPECT_NEAR(shownAt(1.25), 0.8, kExact);
  EXPECT_NEAR(shownAt(2), 0.2, kExact);
}

TEST_F(ProjectorCorePriority, HoldsUntilTheGivenTimeWithoutRepetition) {
  LightCommand held = manual(1, 0.9);
  held.hold_until_utime = at(60);
  give(held, 0);
  for (int second = 0; second < 70; second += 2) give(script(1, 0.2), second);
  EXPECT_EQ(evaluate(dut.frame(at(68)).field, 0, 0), 0.2);
  EXPECT_EQ(dut.frame(at(69)).first_shown_utime, at(68));
}

TEST_F(ProjectorCorePriority, HoldsExactlyUntilTheGivenTime) {
  give(script(1, 0.2), 0);
  LightCommand held = manual(1, 0.9);
  held.hold_until_utime = at(2);
  give(held, 0);
  EXPECT_EQ(shownAt(1.999), 0.9);
  EXPECT_EQ(shownAt(2), 0.2);
}

TEST_F(ProjectorCorePriority, FadesBackFromAHoldWithTheRampOfItsCommand) {
  LightCommand held = script(1, 1);
  held.ramp = 0.5;
  held.hold_until_utime = at(2);
  give(held, 0);
  EXPECT_EQ(shownAt(1.9), 1);
  EXPECT_NEAR(shownAt(2.25), 0.5 + 0.5 * kSafe, kExact);
  EXPECT_EQ(shownAt(2.5), kSafe);
}

TEST_F(ProjectorCorePriority, AmongEqualsTheLatestCommandControlsTheLight) {
  give(script(1, 0.2), 0);
  LightCommand other = script(1, 0.5);
  other.sender = "another";
  give(other, 0.1);
  EXPECT_EQ(shownAt(0.2), 0.5);
  give(script(2, 0.3), 0.3);
  EXPECT_EQ(shownAt(0.4), 0.3);
}

TEST_F(ProjectorCorePriority, MayBeLoweredByItsSender) {
  give(script(1, 0.2), 0);
  give(manual(1, 0.9), 0.1);
  LightCommand lower = manual(2, 0.7);
  lower.priority = -1;
  lower.ramp = 1;
  give(lower, 1);
  EXPECT_NEAR(shownAt(1.5), 0.55, kExact);
  EXPECT_NEAR(shownAt(2), 0.2, kExact);
}

TEST_F(ProjectorCoreSilence, EndsACommandAtTheTimeoutAndReportsIt) {
  give(script(1, 0.6), 0);
  EXPECT_EQ(shownAt(2.499), 0.6);
  const ShownFrame& shown = dut.frame(at(2.5));
  EXPECT_EQ(evaluate(shown.field, 0, 0), kSafe);
  EXPECT_TRUE(shown.changed);
  EXPECT_EQ(shown.commander, "");
  EXPECT_EQ(shown.label, "safe field: lab fell silent");
}

TEST_F(ProjectorCoreSilence, RestartsAtEveryRepetition) {
  for (int half = 0; half <= 20; ++half) {
    EXPECT_EQ(give(script(1, 0.6), 0.5 * half),
              half == 0 ? Verdict::kAccepted : Verdict::kRepeated);
  }
  EXPECT_EQ(shownAt(12), 0.6);
}

TEST_F(ProjectorCoreSilence, EndsAtOnceEvenWhenTheCommandHadARamp) {
  LightCommand command = script(1, 0.6);
  command.ramp = 1;
  give(command, 0);
  EXPECT_EQ(shownAt(2.5), kSafe);
}

TEST_F(ProjectorCoreSilence, EndsWhenTheSenderIsHeardAgain) {
  give(script(1, 0.6), 0);
  EXPECT_EQ(shownAt(5), kSafe);
  EXPECT_EQ(give(script(1, 0.6), 5.1), Verdict::kRepeated);
  const ShownFrame& shown = dut.frame(at(5.2));
  EXPECT_EQ(evaluate(shown.field, 0, 0), 0.6);
  EXPECT_EQ(shown.first_shown_utime, at(5.2));
}

TEST_F(ProjectorCoreSilence, OfAnOverrideReturnsControlToTheScript) {
  give(manual(1, 0.9), 0);
  give(script(1, 0.2), 1);
  EXPECT_EQ(shownAt(2.4), 0.9);
  EXPECT_EQ(shownAt(2.5), 0.2);
}

TEST_F(ProjectorCoreOrder, IgnoresOlderCommandsOfTheSameSender) {
  give(script(5, 0.6), 0);
  EXPECT_EQ(give(script(4, 0.1), 0.1), Verdict::kStale);
  EXPECT_EQ(shownAt(0.2), 0.6);
}

TEST_F(ProjectorCoreOrder, RecognisesRepetitions) {
  give(script(5, 0.6), 0);
  EXPECT_EQ(shownAt(0.1), 0.6);
  EXPECT_EQ(give(script(5, 0.6), 0.2), Verdict::kRepeated);
  const ShownFrame& shown = dut.frame(at(0.3));
  EXPECT_FALSE(shown.changed);
  EXPECT_EQ(shown.first_shown_utime, at(0.1));
}

TEST_F(ProjectorCoreOrder, FollowsANewInstanceWithAnySeqAndIgnoresTheOldOne) {
  give(script(5, 0.6), 0);
  LightCommand restarted = script(1, 0.3);
  restarted.instance = 8;
  EXPECT_EQ(give(restarted, 0.1), Verdict::kAccepted);
  EXPECT_EQ(give(script(6, 0.9), 0.2), Verdict::kStale);
  EXPECT_EQ(shownAt(0.3), 0.3);
}

TEST_F(ProjectorCoreOrder, DropsTheScheduledCommandsOfAnOldInstance) {
  LightCommand planned = script(5, 0.6);
  planned.from_utime = at(1);
  give(planned, 0);
  LightCommand restarted = script(1, 0.3);
  restarted.instance = 8;
  restarted.from_utime = at(2);
  give(restarted, 0.1);
  EXPECT_EQ(shownAt(1.5), kSafe);
  EXPECT_EQ(shownAt(2), 0.3);
}

TEST_F(ProjectorCoreRefusal, ChangesNothingAndGivesTheReason) {
  give(script(1, 0.6), 0);
  shownAt(0.1);
  LightCommand wrong = script(2, 1.2);
  const Answer answer = dut.apply(wrong, at(0.2));
  EXPECT_EQ(answer.verdict, Verdict::kRefused);
  EXPECT_EQ(answer.reason, "layers[0].intensity = 1.2, allowed: 0 to 1");
  const ShownFrame& shown = dut.frame(at(0.3));
  EXPECT_FALSE(shown.changed);
  EXPECT_EQ(shown.seq, 1);
  EXPECT_EQ(give(script(2, 0.7), 0.4), Verdict::kAccepted);
}

TEST_F(ProjectorCoreRefusal, NamesTheField) {
  const auto reason = [&](const LightCommand& command) {
    const Answer answer = dut.apply(command, at(0));
    EXPECT_EQ(answer.verdict, Verdict::kRefused);
    return answer.reason;
  };
  LightCommand command = script(1, 0.5);
  command.ramp = -1;
  EXPECT_EQ(reason(command), "ramp = -1 s, allowed: 0 to 3600 s");
  command.ramp = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(reason(command), "ramp = nan s, allowed: 0 to 3600 s");
  command = script(1, 0.5);
  command.from_utime = at(0) * 1000;
  EXPECT_THAT(reason(command), HasSubstr("from_utime = 1000000000000000 us"));
  command = script(1, 0.5);
  command.hold_until_utime = at(0);
  EXPECT_THAT(reason(command), HasSubstr("hold_until_utime = 1000000000000 us"));
  command = script(1, 0.5);
  command.sender.clear();
  EXPECT_THAT(reason(command), HasSubstr("sender"));
  command = script(1, 0.5);
  command.layers[0].layer.kind = LayerKind::kFade;
  EXPECT_EQ(reason(command), "layers[0].kind = 10, allowed in a command: any but 10");
  EXPECT_EQ(shownAt(0.1), kSafe);
}

TEST_F(ProjectorCoreRefusal, LimitsTheNumberOfScheduledCommands) {
  int accepted = 0;
  for (int step = 1; step <= 20; ++step) {
    LightCommand command = script(step, 0.5);
    command.from_utime = at(step);
    accepted += give(command, 0) == Verdict::kAccepted ? 1 : 0;
  }
  EXPECT_EQ(accepted, static_cast<int>(ProjectorCore::kMostScheduled));
}

TEST_F(ProjectorCoreSenders, BeyondTheLimitAreRefusedAndTheScriptStaysInControl) {
  give(script(1, 0.2), 0);
  int accepted = 0;
  for (int i = 0; i < 100'000; ++i) {
    LightCommand command = stranger(i);
    command.hold_until_utime = at(3600);
    accepted += give(command, 0.1) == Verdict::kAccepted ? 1 : 0;
  }
  EXPECT_EQ(accepted, static_cast<int>(ProjectorCore::kMostSenders) - 1);
  const Answer answer = dut.apply(stranger(100'000), at(0.2));
  EXPECT_EQ(answer.verdict, Verdict::kRefused);
  EXPECT_EQ(answer.reason,
            "senders = 65, allowed: at most 64 with commands; end the programs that do not belong "
            "to this lab");
  EXPECT_EQ(give(script(2, 0.7), 0.3), Verdict::kAccepted);
  EXPECT_EQ(shownAt(0.4), 0.7);
}

TEST_F(ProjectorCoreSenders, WithoutACommandAreForgottenAndTheLongestSilentOneFirst) {
  LightCommand lasting = script(5, 0.2);
  lasting.hold_until_utime = at(3600);
  give(lasting, 0);
  LightCommand planned = stranger(-1);
  planned.from_utime = at(3600);
  planned.hold_until_utime = at(7200);
  give(planned, 0);
  const auto gone = [](int number, std::int64_t seq) {
    LightCommand command = stranger(number);
    command.seq = seq;
    command.release = true;
    return command;
  };
  int accepted = 0;
  for (int i = 0; i < 100'000; ++i) {
    accepted += give(gone(i, 5), 1 + 1e-3 * i) == Verdict::kAccepted ? 1 : 0;
  }
  EXPECT_EQ(accepted, 100'000);
  const int kept = static_cast<int>(ProjectorCore::kMostSenders) - 2;
  EXPECT_EQ(give(gone(100'000 - kept, 4), 102), Verdict::kStale) << "it is remembered";
  EXPECT_EQ(give(gone(100'000 - kept - 1, 4), 102), Verdict::kAccepted) << "it is forgotten";
  EXPECT_EQ(give(script(4, 0.9), 103), Verdict::kStale);
  EXPECT_EQ(shownAt(103), 0.2);
  EXPECT_EQ(shownAt(3600), 0.9) << "what is planned is kept as well";
}

TEST(ProjectorCoreConfig, NeedsAValidSafeFieldAndATimeout) {
  EXPECT_THROW(ProjectorCore({uniform(1.5), 2.5, {}}), std::invalid_argument);
  EXPECT_THROW(ProjectorCore({uniform(0.5), 0, {}}), std::invalid_argument);
}

}  // namespace
}  // namespace lab::projector
