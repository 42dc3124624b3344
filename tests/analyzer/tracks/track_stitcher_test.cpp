#include "analyzer/tracks/track_stitcher.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include "common/math/units.hpp"

namespace lab::analysis {
namespace {

using units::kNan;
constexpr double kSpeed = 0.03;  // m/s

/// A robot that drives straight along x at 3 cm/s, recorded at 50 frames/s, telemetry at 25 Hz.
class TrackStitcherTest : public testing::Test {
 protected:
  void frame(double t, double x) {
    TrackPoint point;
    point.time = t;
    point.frame = ++frame_;
    point.x = x;
    dut.addFrame(point, out);
  }

  void telemetry(double t) {
    state.time = t;
    state.v_l = state.v_r = kSpeed;
    dut.addTelemetry(state, out);
  }

  /// Frames and telemetry of free motion in [from, to), starting at x.
  void drive(double from, double to, double x) {
    const int frames = static_cast<int>(std::lround((to - from) * 50));
    for (int i = 0; i < frames; ++i) {
      const double t = from + 0.02 * i;
      if (i % 2 == 0) {
        telemetry(t);
      }
      frame(t, x + kSpeed * (t - from));
    }
  }

  [[nodiscard]] std::size_t segments() const {
    std::set<int> ids;
    for (const Sample& sample : out) {
      ids.insert(sample.segment);
    }
    return ids.size();
  }

  /// Every pair of consecutive samples of a segment moves at 3 cm/s in free time.
  void expectUniformMotion() const {
    for (std::size_t i = 1; i < out.size(); ++i) {
      if (out[i].segment == out[i - 1].segment) {
        EXPECT_NEAR(out[i].x - out[i - 1].x, kSpeed * (out[i].free_time - out[i - 1].free_time),
                    1e-9)
            << "at " << out[i].time;
      }
    }
  }

  static RobotTelemetry initial() {
    RobotTelemetry telemetry;
    telemetry.program = 0;
    telemetry.program_epoch = 1;
    return telemetry;
  }

  TrackStitcher dut{StitcherConfig{}};
  std::vector<Sample> out;
  RobotTelemetry state = initial();

 private:
  std::int64_t frame_ = 0;
};

TEST_F(TrackStitcherTest, PassesFreeMotionUnchanged) {
  drive(0, 4, 0);
  dut.flush(out);
  EXPECT_EQ(segments(), 1U);
  EXPECT_GE(out.size(), 199U);
  EXPECT_EQ(dut.counters().frames, 200);
  expectUniformMotion();
}

TEST_F(TrackStitcherTest, RemovesAReportedReversalAndKeepsTheFreeMotion) {
  drive(0, 1, 0);
  // Reversing 0.4 m from 1.013 s to 5.007 s; the robot resumes at x = 0.03 * 1.013 - 0.4.
  state.reversal_count = 1;
  state.reversal_start = 1.013;
  state.reversing = true;
  for (double t = 1.02; t < 5; t += 0.02) {
    telemetry(t);
    frame(t, 0.03 * 1.013 - 0.1 * (t - 1.013));
  }
  state.reversing = false;
  state.reversal_end = 5.007;
  drive(5.02, 6, 0.03 * 1.013 - 0.4 + 0.03 * 0.013);
  dut.flush(out);

  EXPECT_EQ(segments(), 1U);
  EXPECT_EQ(dut.counters().reversals, 1);
  EXPECT_EQ(dut.tally(0).reversals, 1);
  EXPECT_GT(dut.counters().in_reversal, 190);
  EXPECT_NE(out.front().piece, out.back().piece);
  EXPECT_NEAR(out.back().free_time - out.front().free_time,
              out.back().time - out.front().time - (5.007 - 1.013), 1e-9);
  expectUniformMotion();
}

TEST_F(TrackStitcherTest, JoinsAcrossAReversalWhoseBeginningWasNotReported) {
  drive(0, 1, 0);
  // Telemetry is lost during the whole reversal; the next message still gives both times.
  for (double t = 1.02; t < 1.3; t += 0.02) {
    frame(t, 0.03 * 1.01 - 0.1 * (t - 1.01));
  }
  state.reversal_count = 1;
  state.reversal_start = 1.01;
  state.reversal_end = 1.31;
  drive(1.32, 2, 0.03 * 1.01 - 0.03 + 0.03 * 0.01);
  dut.flush(out);
  EXPECT_EQ(segments(), 1U);
  EXPECT_EQ(dut.counters().reversals, 1);
  expectUniformMotion();
}

TEST_F(TrackStitcherTest, CutsIfTheTimesOfAReversalAreLost) {
  drive(0, 1, 0);
  state.reversal_count = 2;  // two reversals since the last message: the first is unknown
  state.reversal_start = 1.5;
  state.reversal_end = 1.6;
  drive(2, 3, 0.5);
  dut.flush(out);
  EXPECT_EQ(segments(), 2U);
  EXPECT_EQ(dut.counters().lost_reversals, 1);
  expectUniformMotion();
}

TEST_F(TrackStitcherTest, CutsAtANewProgramEpochAtItsExactTime) {
  drive(0, 1, 0);
  state.program_epoch = 2;
  state.program_start = 0.99;
  state.program = 3;
  drive(1, 2, 0.03);
  dut.flush(out);
  EXPECT_EQ(segments(), 2U);
  for (const Sample& sample : out) {
    EXPECT_EQ(sample.program, sample.time < 0.99 ? 0 : 3) << sample.time;
  }
  EXPECT_EQ(dut.tally(3).segments, 1);
}

TEST_F(TrackStitcherTest, DropsFramesOfAnEpochWithoutTelemetry) {
  drive(0, 1, 0);
  state.program_epoch = 3;
  state.program_start = 1.5;
  for (double t = 1; t < 1.5; t += 0.02) {
    frame(t, 0.03 * t);
  }
  drive(1.52, 2, 0.03 * 1.52);
  dut.flush(out);
  for (const Sample& sample : out) {
    EXPECT_TRUE(sample.time < 1 || sample.time > 1.5) << sample.time;
  }
  EXPECT_GT(dut.counters().uncovered, 20);
}

TEST_F(TrackStitcherTest, CutsContactsWithAGuardAndCountsTheirShare) {
  drive(0, 1, 0);
  state.contact = true;
  drive(1, 1.2, 0.03);
  state.contact = false;
  drive(1.2, 2.2, 0.036);
  dut.flush(out);
  EXPECT_EQ(segments(), 2U);
  for (const Sample& sample : out) {
    EXPECT_TRUE(sample.time < 0.9 + 1e-9 || sample.time > 1.25) << sample.time;
  }
  EXPECT_EQ(dut.counters().in_contact, dut.tally(0).in_contact);
  // From 0.1 s before the first message of the contact to 0.1 s after the last, 50 frames/s.
  EXPECT_NEAR(static_cast<double>(dut.tally(0).in_contact), 18, 2);
}

TEST_F(TrackStitcherTest, DropsStandingAndStoppedRobots) {
  drive(0, 1, 0);
  state.stopped = true;
  drive(1, 2, 0.03);
  state.stopped = false;
  drive(2, 3, 0.06);
  dut.flush(out);
  EXPECT_EQ(segments(), 2U);
  EXPECT_GE(dut.counters().standing, 50);
  state.program = -1;
  state.program_epoch = 2;
  state.program_start = 3;
  const std::size_t before = out.size();
  drive(3, 4, 0.09);
  dut.flush(out);
  EXPECT_LE(out.size(), before + 1);
}

TEST_F(TrackStitcherTest, CutsAtAJumpThatTheWheelsCannotMake) {
  drive(0, 1, 0);
  drive(1, 2, 0.5);  // moved by hand, without a report
  dut.flush(out);
  EXPECT_EQ(segments(), 2U);
  EXPECT_EQ(dut.counters().jumps, 1);
}

TEST_F(TrackStitcherTest, DropsASingleOutlierWithoutACut) {
  drive(0, 1, 0);
  telemetry(1);
  frame(1, 0.7);
  drive(1.02, 2, 0.0306);
  dut.flush(out);
  EXPECT_EQ(segments(), 1U);
  EXPECT_EQ(dut.counters().outliers, 1);
  expectUniformMotion();
}

TEST_F(TrackStitcherTest, KeepsTheSegmentButNotTheHeadingAcrossALongGap) {
  drive(0, 1, 0);
  for (double t = 1; t < 1.4; t += 0.04) {
    telemetry(t);
  }
  drive(1.4, 2, 0.042);
  dut.flush(out);
  EXPECT_EQ(segments(), 1U);
  EXPECT_NE(out.front().angular_segment, out.back().angular_segment);
  expectUniformMotion();
}

TEST_F(TrackStitcherTest, UnwrapsTheHeading) {
  for (int i = 0; i < 400; ++i) {
    telemetry(0.02 * i);
    TrackPoint point;
    point.time = 0.02 * i;
    point.theta = std::remainder(3 * point.time, 2 * std::numbers::pi);
    dut.addFrame(point, out);
  }
  dut.flush(out);
  EXPECT_NEAR(out.back().theta - out.front().theta, 3 * 0.02 * 399, 1e-9);
  EXPECT_EQ(out.front().angular_segment, out.back().angular_segment);
}

TEST_F(TrackStitcherTest, GivesTheSameSamplesForLateAndReorderedTelemetry) {
  drive(0, 3, 0);
  dut.flush(out);
  const std::vector<Sample> in_order = out;

  TrackStitcher late{StitcherConfig{}};
  std::vector<Sample> result;
  RobotTelemetry message = initial();
  message.v_l = message.v_r = kSpeed;
  for (int i = 0; i < 150; ++i) {
    TrackPoint point;
    point.time = 0.02 * i;
    point.frame = i + 1;
    point.x = kSpeed * point.time;
    late.addFrame(point, result);
    // Pairs of messages arrive swapped and 0.2 s late.
    if (i >= 14 && i % 4 == 2) {
      for (const int index : {i - 10, i - 12}) {
        message.time = 0.02 * (index / 2 * 2);
        late.addTelemetry(message, result);
      }
    }
  }
  message.time = 3;
  late.addTelemetry(message, result);
  late.flush(result);
  EXPECT_EQ(late.counters().uncovered, 0);
  ASSERT_GE(result.size(), in_order.size());
  for (std::size_t i = 0; i < in_order.size(); ++i) {
    EXPECT_EQ(result[i].time, in_order[i].time);
    EXPECT_EQ(result[i].x, in_order[i].x);
  }
}

TEST_F(TrackStitcherTest, DropsAFrameWithoutTelemetryAfterTheDelayAndOnlyThatFrame) {
  drive(0, 1, 0);
  for (double t = 1; t < 3; t += 0.02) {
    frame(t, 0.03 * t);
  }
  EXPECT_GT(dut.counters().uncovered, 60);  // those older than 0.5 s
  drive(3, 4, 0.09);
  dut.flush(out);
  EXPECT_EQ(segments(), 1U);
  EXPECT_EQ(dut.tally(0).lost, dut.counters().uncovered);
  expectUniformMotion();
}

TEST_F(TrackStitcherTest, CountsAndDropsInvalidAndRepeatedFrames) {
  drive(0, 1, 0);
  frame(0.98, 0.0294);  // repeated
  frame(0.5, 0.015);    // earlier
  frame(kNan, 0);       // no time
  frame(1.0, kNan);     // no position
  TrackPoint doubtful;
  doubtful.time = 1.01;
  doubtful.valid = false;
  dut.addFrame(doubtful, out);
  drive(1.02, 2, 0.0306);
  dut.flush(out);
  EXPECT_EQ(dut.counters().out_of_order, 2);
  EXPECT_EQ(dut.counters().invalid, 3);
  EXPECT_EQ(segments(), 1U);
  expectUniformMotion();
}

TEST_F(TrackStitcherTest, CountsAndDropsInvalidTelemetry) {
  drive(0, 1, 0);
  telemetry(0.96);  // repeated
  RobotTelemetry broken = state;
  broken.time = kNan;
  dut.addTelemetry(broken, out);
  broken.time = 1;
  broken.reversal_count = 1;
  broken.reversal_start = kNan;
  dut.addTelemetry(broken, out);
  EXPECT_EQ(dut.counters().bad_telemetry, 3);
}

TEST_F(TrackStitcherTest, RestartsIfTheCameraClockWasSetBack) {
  drive(1000, 1001, 0);
  dut.flush(out);
  const std::size_t before = out.size();
  drive(5, 8, 0.2);
  dut.flush(out);
  EXPECT_GT(out.size(), before + 80);
  EXPECT_EQ(segments(), 2U);
  expectUniformMotion();
}

TEST_F(TrackStitcherTest, CutsWhenTheRobotRebooted) {
  state.reversal_count = 7;
  state.reversal_start = -20;
  state.reversal_end = -16;
  drive(0, 1, 0);
  state.reversal_count = 0;
  drive(1, 2, 0.03);
  dut.flush(out);
  EXPECT_EQ(segments(), 2U);
}

TEST_F(TrackStitcherTest, InterpolatesTheRunTimeBetweenTwoMessages) {
  // Straight runs from 1.01 s to 2.03 s, in a program of its own; telemetry every 40 ms.
  for (int i = 0; i < 150; ++i) {
    const double t = 0.02 * i;
    if (i % 2 == 0) {
      const int epoch = t < 1.01 ? 1 : t < 2.03 ? 2 : 3;
      state.program = epoch;
      state.program_epoch = epoch;
      state.program_start = epoch == 1 ? 0 : epoch == 2 ? 1.01 : 2.03;
      state.run_time = std::clamp(t - 1.01, 0.0, 2.03 - 1.01);
      telemetry(t);
    }
    frame(t, kSpeed * t);
  }
  dut.flush(out);
  EXPECT_EQ(segments(), 3U);
  for (const Sample& sample : out) {
    EXPECT_NEAR(sample.run_time, std::clamp(sample.time - 1.01, 0.0, 2.03 - 1.01), 1e-9)
        << sample.time;
  }
}

TEST_F(TrackStitcherTest, ReportsWhatTheRobotDidInEveryFrame) {
  StitcherConfig config;
  config.report_frames = true;
  dut = TrackStitcher(config);
  state.light_front = 0.25F;
  drive(0, 1, 0);
  state.reversal_count = 1;
  state.reversal_start = 1.01;
  state.reversing = true;
  drive(1.02, 2, 0.03);
  state.reversing = false;
  state.reversal_end = 2.01;
  drive(2.02, 3, 0.06);
  state.contact = state.contact_wall = true;
  drive(3, 4, 0.09);
  state.contact = state.contact_wall = false;
  state.stopped = true;
  drive(4, 5, 0.12);
  state.stopped = false;
  state.program = -1;
  state.program_epoch = 2;
  state.program_start = 5;
  drive(5, 6, 0.12);
  frame(6, 0.15);  // after the last telemetry
  dut.flush(out);

  std::vector<FrameState> states;
  for (const FrameReport& frame : dut.takeReports()) {
    if (states.empty() || states.back() != frame.state) states.push_back(frame.state);
    if (frame.state != FrameState::kLost) {
      EXPECT_EQ(frame.light_front, 0.25F);
    }
    if (frame.state == FrameState::kContact && frame.time > 3.1 && frame.time < 3.9) {
      EXPECT_TRUE(frame.contact_wall);
      EXPECT_FALSE(frame.contact_robot);
    }
  }
  EXPECT_EQ(states, (std::vector{FrameState::kFree, FrameState::kReversing, FrameState::kFree,
                                 FrameState::kContact, FrameState::kStopped, FrameState::kOther,
                                 FrameState::kLost}));
  EXPECT_GT(dut.tally(0).in_reversal, 40);
  EXPECT_GT(dut.tally(0).in_contact, 40);
  EXPECT_GT(dut.tally(0).stopped, 40);
}

}  // namespace
}  // namespace lab::analysis
