#include "analyzer/service/analysis.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/analyzer/paper_programs.hpp"
#include "tests/analyzer/walker.hpp"

namespace lab::analysis {
namespace {

/// The messages of a recording in their order, to be fed to an Analysis.
struct MessageSequence {
  struct Event {
    bool is_frame = false;
    TrackPoint point;
    RobotTelemetry telemetry;
  };
  std::vector<Event> events;
};

MessageSequence record(const ProgramLaw& law, double duration, std::uint64_t seed) {
  WalkerRecording recording;
  recording.law = law;
  recording.duration = duration;
  recording.walls = true;
  recording.seed = seed;
  MessageSequence messages;
  Walker walker(recording);
  walker.on_frame = [&](const TrackPoint& point) { messages.events.push_back({true, point, {}}); };
  walker.on_telemetry = [&](const RobotTelemetry& telemetry) {
    messages.events.push_back({false, {}, telemetry});
  };
  walker.run();
  return messages;
}

Frame frameOf(int robot, const TrackPoint& point) {
  return {point.time, point.frame, {{robot, point.x, point.y, point.theta, 0, 0, true}}};
}

void feed(Analysis& dut, const MessageSequence& messages, int robot, const ProgramLaw& law) {
  for (const MessageSequence::Event& event : messages.events) {
    if (event.is_frame) {
      dut.addFrame(frameOf(robot, event.point));
    } else {
      dut.addTelemetry(robot, law, event.telemetry);
    }
  }
}

AnalysisConfig config(double frame_period = 1 / 49.7) {
  AnalysisConfig result;
  result.frame_period = frame_period;
  result.max_lag = 20;
  return result;
}

TEST(Analysis, GivesThePoolAndEveryRobotOfAProgram) {
  const ProgramLaw law = abpLaw(3, 0.5);
  Analysis dut(config());
  feed(dut, record(law, 300, 1), 4, law);
  feed(dut, record(law, 300, 2), 9, law);
  dut.flush();
  int pauses = 0;
  const std::vector<ProgramResult> results = dut.results(Depth::kLive, [&pauses] { ++pauses; });

  ASSERT_EQ(results.size(), 3U);
  EXPECT_EQ(pauses, 2) << "a heartbeat can be sent after each robot";
  EXPECT_EQ(results[0].robot, kPool);
  EXPECT_EQ(results[0].robots, 2);
  EXPECT_EQ(results[1].robot, 4);
  EXPECT_EQ(results[2].robot, 9);
  EXPECT_NEAR(results[0].observed, results[1].observed + results[2].observed, 1e-6);
  EXPECT_EQ(results[0].reversals, results[1].reversals + results[2].reversals);
  EXPECT_EQ(results[0].samples, results[1].samples + results[2].samples);
  EXPECT_LT(results[0].estimates[0].sigma, results[1].estimates[0].sigma);
  EXPECT_EQ(results[0].verdict.kind, VerdictKind::kAgrees);
}

TEST(Analysis, GivesTheSameResultsForAnyNumberOfQueries) {
  const ProgramLaw law = rtpLaw(3, 0.5);
  const MessageSequence messages = record(law, 200, 3);
  Analysis offline(config());
  feed(offline, messages, 1, law);
  offline.flush();
  Analysis online(config());
  int asked = 0;
  for (const MessageSequence::Event& event : messages.events) {
    if (event.is_frame) {
      online.addFrame(frameOf(1, event.point));
    } else {
      online.addTelemetry(1, law, event.telemetry);
    }
    if (++asked % 2000 == 0) {
      EXPECT_LE(online.results().size(), 2U);
    }
  }
  online.flush();
  const ProgramResult a = offline.results().front();
  const ProgramResult b = online.results().front();
  ASSERT_EQ(a.curves.msd.size(), b.curves.msd.size());
  for (std::size_t i = 0; i < a.curves.msd.size(); ++i) {
    EXPECT_EQ(a.curves.msd[i].windows, b.curves.msd[i].windows);
    if (a.curves.msd[i].windows > 0) {
      EXPECT_EQ(a.curves.msd[i].value, b.curves.msd[i].value);
      EXPECT_EQ(a.curves.msd[i].sigma, b.curves.msd[i].sigma);
    }
  }
  ASSERT_EQ(a.estimates.size(), b.estimates.size());
}

TEST(Analysis, EstimatesTheFramePeriod) {
  const ProgramLaw law = abpLaw(3, 0.5);
  const MessageSequence messages = record(law, 100, 5);
  Analysis given(config());
  Analysis found(config(0));
  feed(given, messages, 1, law);
  feed(found, messages, 1, law);
  given.flush();
  found.flush();
  ASSERT_EQ(found.results().size(), 2U);
  EXPECT_EQ(found.results()[0].samples, given.results()[0].samples);
  EXPECT_NEAR(found.results()[0].curves.msd[0].tau, 1 / 49.7, 1e-6);
  EXPECT_EQ(found.results()[0].curves.msd[0].windows, given.results()[0].curves.msd[0].windows);
}

TEST(Analysis, DropsARobotSeenTwiceInAFrame) {
  const ProgramLaw law = abpLaw(3, 0.5);
  Analysis dut(config());
  for (const MessageSequence::Event& event : record(law, 20, 6).events) {
    if (!event.is_frame) {
      dut.addTelemetry(1, law, event.telemetry);
      continue;
    }
    Frame frame = frameOf(1, event.point);
    if (event.point.frame % 10 == 0) {
      frame.poses.push_back(frame.poses[0]);
      frame.poses.back().x += 0.3;
    }
    dut.addFrame(frame);
  }
  dut.flush();
  EXPECT_NEAR(static_cast<double>(dut.counters().duplicate_robots), 2 * 99, 2);
  EXPECT_EQ(dut.robotCounters(1).outliers, 0);
  EXPECT_EQ(dut.results().front().segments, 1);
}

TEST(Analysis, IgnoresProgramsWithoutALaw) {
  Analysis dut(config());
  feed(dut, record(abpLaw(3, 0.5), 20, 7), 1, ProgramLaw());
  dut.flush();
  EXPECT_TRUE(dut.results().empty());
  EXPECT_GT(dut.robotCounters(1).standing, 900);
}

/// A robot that switches every 10 s between two programs (by light), 40 times.
void feedSwitches(Analysis& dut) {
  const ProgramLaw laws[] = {abpLaw(3, 0.5), noisyLaw(0, 0.07, 0.2)};
  RobotTelemetry telemetry;
  double theta = 0;
  for (int i = 0; i < 400 * 50; ++i) {
    const double t = 0.02 * i;
    const int stay = static_cast<int>(t / 10);
    telemetry.time = t;
    telemetry.program_epoch = stay + 1;
    telemetry.program_start = 10.0 * stay + 0.001 * (i % 3);  // as converted from another clock
    dut.addTelemetry(1, laws[stay % 2], telemetry);
    theta += 0.02 * std::sin(0.7 * t);
    dut.addFrame(
        {t, i, {{1, 0.6 + 0.01 * std::sin(t), 0.4, std::remainder(theta, 6.28), 0, 0, true}}});
  }
  dut.flush();
}

TEST(Analysis, CutsAtSwitchesAndKeepsTheProgramsApart) {
  Analysis dut(config(0.02));
  feedSwitches(dut);
  const std::vector<ProgramResult> results = dut.results();
  ASSERT_EQ(results.size(), 4U);
  EXPECT_EQ(results[0].segments, 20);
  EXPECT_EQ(results[2].segments, 20);
  EXPECT_NEAR(results[0].observed, 200, 1);
  EXPECT_NEAR(dut.medianDwellTime(0), 10, 0.003);
}

TEST(Analysis, GivesNoVerdictOnLagsThatTheLightSelects) {
  Analysis uniform(config(0.02));
  feedSwitches(uniform);
  EXPECT_EQ(uniform.results()[0].unbiased_lag, 0);
  Analysis dut(config(0.02));
  dut.setSpatialLight(true);
  feedSwitches(dut);
  dut.setSpatialLight(false);  // the selection persists
  const ProgramResult result = dut.results()[0];
  EXPECT_NEAR(result.unbiased_lag, 1, 0.001);
  int biased = 0;
  for (const CurvePoint& point : result.curves.msd) {
    EXPECT_EQ(point.selection_biased, point.tau > result.unbiased_lag);
    EXPECT_FALSE(point.selection_biased && point.judged);
    biased += point.selection_biased ? 1 : 0;
  }
  EXPECT_GT(biased, 10);
}

TEST(Analysis, GivesNanForLagsThatWereNotObserved) {
  Analysis dut(config(0.02));
  feedSwitches(dut);
  for (const ProgramResult& result : dut.results()) {
    for (const CurvePoint& point : result.curves.msd) {
      EXPECT_EQ(point.windows > 0, point.tau < 10);
      EXPECT_EQ(std::isnan(point.value), point.windows == 0);
      EXPECT_EQ(std::isnan(point.sigma), point.windows == 0);
    }
  }
}

TEST(Analysis, PassesEverySampleToTheSink) {
  const ProgramLaw law = abpLaw(3, 0.5);
  Analysis dut(config());
  std::int64_t samples = 0;
  dut.onSample([&](int robot, const ProgramLaw& sampled, const Sample& sample) {
    EXPECT_EQ(robot, 1);
    EXPECT_EQ(sampled, law);
    EXPECT_TRUE(std::isfinite(sample.x));
    ++samples;
  });
  feed(dut, record(law, 60, 8), 1, law);
  dut.flush();
  EXPECT_EQ(samples, dut.results()[0].samples);
}

TEST(Analysis, ToleratesInvalidInput) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const ProgramLaw law = abpLaw(3, 0.5);
  Analysis dut(config(0));
  dut.flush();
  EXPECT_TRUE(dut.results().empty());
  dut.addFrame({nan, 0, {{1, nan, nan, nan, nan, nan, true}}});
  dut.addFrame({0, 0, {}});
  RobotTelemetry broken;
  broken.time = nan;
  dut.addTelemetry(1, law, broken);
  feed(dut, record(law, 30, 9), 1, law);
  dut.flush();
  EXPECT_EQ(dut.results().size(), 2U);
}

/// A robot that drives freely for `free` seconds and then pushes against a wall for `held` seconds,
/// again and again.
std::vector<ProgramResult> resultsInTheCorner(double free, double held) {
  const ProgramLaw law = abpLaw(3, 0.5);
  WalkerRecording recording;
  recording.law = law;
  recording.duration = 900;
  recording.seed = 11;
  AnalysisConfig settings = config();
  settings.whole_motion = settings.stitcher.report_frames = true;
  Analysis dut(settings);
  Walker walker(recording);
  const auto isHeld = [&](double time) { return std::fmod(time, free + held) >= free; };
  // Time passes for the camera, and not for the robot.
  double lost = 0;
  TrackPoint before;
  walker.on_frame = [&](const TrackPoint& point) {
    TrackPoint now = point;
    now.time += lost;
    dut.addFrame(frameOf(1, now));
    before = now;
  };
  walker.on_telemetry = [&](RobotTelemetry telemetry) {
    telemetry.time += lost;
    if (isHeld(telemetry.time)) {
      const double end = telemetry.time + held;
      for (double t = telemetry.time; t < end; t += 1 / 49.7) {
        telemetry.time = t;
        telemetry.contact = true;
        dut.addTelemetry(1, law, telemetry);
        TrackPoint standing = before;
        standing.time = t + 1e-3;
        dut.addFrame(frameOf(1, standing));
      }
      lost += held;
      telemetry.time += 1 / 49.7;
      telemetry.contact = false;
    }
    dut.addTelemetry(1, law, telemetry);
  };
  walker.run();
  dut.flush();
  return dut.results();
}

TEST(Analysis, HasTheWholeMotionBesideTheFreeOne) {
  const ProgramResult dut = resultsInTheCorner(10, 5).front();

  EXPECT_NEAR(dut.shares.contact, 1 / 3.0, 0.03);
  EXPECT_NEAR(dut.shares.free + dut.shares.contact + dut.shares.lost, 1, 1e-9);
  EXPECT_EQ(dut.verdict.kind, VerdictKind::kAgrees);
  ASSERT_TRUE(dut.whole.has_value());
  EXPECT_NEAR(dut.whole->speed, 0.03 * 2 / 3, 0.001);
  EXPECT_NEAR(dut.whole->observed, 1.5 * 900, 20);
  ASSERT_FALSE(dut.whole->lags.empty());
  // At one frame, the motion is ballistic: two thirds of the windows move.
  const WholeLag& first = dut.whole->lags.front();
  EXPECT_NEAR(first.msd / std::pow(0.03 * first.tau, 2), 2 / 3.0, 0.03);
}

TEST(Analysis, DoesNotJudgeAJam) {
  const ProgramResult dut = resultsInTheCorner(10, 20).front();

  EXPECT_GT(dut.shares.contact, 0.6);
  EXPECT_GE(dut.verdict.judged, 5);
  EXPECT_LT(dut.verdict.max_z, 4);
  EXPECT_EQ(dut.verdict.kind, VerdictKind::kUndecided);
}

TEST(Analysis, ListsAProgramWithoutFreeMotionIfTheWholeIsWanted) {
  AnalysisConfig settings = config();
  settings.whole_motion = settings.stitcher.report_frames = true;
  Analysis dut(settings);
  RobotTelemetry telemetry;
  telemetry.program_epoch = 1;
  telemetry.contact = true;
  for (int i = 0; i < 1000; ++i) {
    telemetry.time = i / 49.7;
    dut.addTelemetry(1, abpLaw(3, 0.5), telemetry);
    TrackPoint point;
    point.time = telemetry.time;
    point.frame = i;
    dut.addFrame(frameOf(1, point));
  }
  dut.flush();
  for (const Depth depth : {Depth::kLive, Depth::kFull}) {
    const std::vector<ProgramResult> results = dut.results(depth);
    ASSERT_EQ(results.size(), 2U);
    EXPECT_EQ(results.front().shares.contact, 1);
    EXPECT_EQ(results.front().verdict.kind, VerdictKind::kUndecided);
    EXPECT_EQ(results.front().whole->lags.front().msd, 0);
  }
}

}  // namespace
}  // namespace lab::analysis
