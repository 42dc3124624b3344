#include "analyzer/curves/msd_accumulator.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "analyzer/curves/lags.hpp"
#include "tests/analyzer/paper_programs.hpp"

namespace lab::analysis::msd_accumulator_test {
namespace {

constexpr double kPeriod = 0.02;  // s

/// A random walk whose frames can be lost, cut and joined.
class Track {
 public:
  void walk(int frames) {
    std::normal_distribution<double> normal(0, 0.001);
    for (int i = 0; i < frames; ++i) {
      sample_.free_time += kPeriod;
      sample_.x += normal(random_);
      sample_.y += normal(random_);
      sample_.theta += 10 * normal(random_);
      samples_.push_back(sample_);
    }
  }
  /// Frames that never arrive.
  void lose(int frames) {
    const std::size_t kept = samples_.size();
    walk(frames);
    samples_.resize(kept);
  }
  void cut() {
    ++sample_.segment;
    ++sample_.piece;
    ++sample_.angular_segment;
    sample_.free_time += 10;
    sample_.x += 100;
  }
  void cutAngle() {
    ++sample_.angular_segment;
    sample_.theta += 3;
  }
  /// A removed reversal: the next frame is `gap` periods (besides one) later in free time.
  void join(double gap) {
    ++sample_.piece;
    sample_.free_time += gap * kPeriod;
  }
  [[nodiscard]] const std::vector<Sample>& samples() const { return samples_; }

 private:
  std::mt19937_64 random_{7};
  Sample sample_;
  std::vector<Sample> samples_;
};

struct Sums {
  int windows = 0;
  int angular_windows = 0;
  double r2 = 0;
  double r4 = 0;
  double a2 = 0;
};

void addWindow(Sums& sums, const Sample& start, const Sample& end) {
  const double r2 = std::pow(end.x - start.x, 2) + std::pow(end.y - start.y, 2);
  ++sums.windows;
  sums.r2 += r2;
  sums.r4 += r2 * r2;
  if (start.angular_segment == end.angular_segment) {
    ++sums.angular_windows;
    sums.a2 += std::pow(end.theta - start.theta, 2);
  }
}

/// The windows of one lag by brute force, over all pairs of samples.
Sums bruteForce(const std::vector<Sample>& samples, int lag) {
  const double tau = lag * kPeriod;
  Sums sums;
  for (std::size_t j = 0; j < samples.size(); ++j) {
    const Sample& end = samples[j];
    for (std::size_t i = 0; i < j; ++i) {
      const Sample& start = samples[i];
      if (start.segment != end.segment) {
        continue;
      }
      if (start.piece == end.piece) {
        if (std::abs(end.free_time - start.free_time - tau) < 0.1 * kPeriod) {
          addWindow(sums, start, end);
        }
        continue;
      }
      // Across a join the start lies between this sample and the next one.
      const Sample& next = samples[i + 1];
      const double at = end.free_time - tau;
      const bool joined_start = next.piece != end.piece || start.piece != next.piece;
      if (joined_start && start.free_time <= at && at < next.free_time - 1e-9 &&
          next.free_time - start.free_time < 2.2 * kPeriod) {
        const double w = (at - start.free_time) / (next.free_time - start.free_time);
        Sample between = start;
        between.x += w * (next.x - start.x);
        between.y += w * (next.y - start.y);
        between.theta += w * (next.theta - start.theta);
        addWindow(sums, between, end);
      }
    }
  }
  return sums;
}

void expectBruteForce(const Track& track, const std::vector<int>& lags) {
  MsdAccumulator dut(lags, kPeriod);
  for (const Sample& sample : track.samples()) {
    dut.add(sample);
  }
  const BlockSums total = dut.data().total();
  for (std::size_t i = 0; i < lags.size(); ++i) {
    const Sums expected = bruteForce(track.samples(), lags[i]);
    const LagSums& measured = total.lags[i];
    EXPECT_EQ(measured.windows, static_cast<unsigned>(expected.windows)) << "lag " << lags[i];
    EXPECT_EQ(measured.angular_windows, static_cast<unsigned>(expected.angular_windows));
    EXPECT_NEAR(measured.r2, expected.r2, 1e-9 * expected.r2);
    EXPECT_NEAR(measured.r4, expected.r4, 1e-9 * expected.r4);
    EXPECT_NEAR(measured.a2, expected.a2, 1e-9 * expected.a2);
    if (expected.windows > 0) {
      EXPECT_NEAR(dut.data().lagTime(i, total), lags[i] * kPeriod, 1e-3 * kPeriod);
    }
  }
}

const std::vector<int> kShortLags{1, 2, 3, 5, 8, 13, 15};

TEST(MsdAccumulator, AgreesWithBruteForceOnAWholeTrack) {
  Track track;
  track.walk(500);
  expectBruteForce(track, kShortLags);
}

TEST(MsdAccumulator, NeedsOnlyTheTwoEndFramesOfAWindow) {
  Track track;
  for (const int lost : {1, 2, 5, 1, 9, 3}) {
    track.walk(40);
    track.lose(lost);
  }
  track.walk(40);
  expectBruteForce(track, kShortLags);
}

TEST(MsdAccumulator, LetsNoWindowCrossACut) {
  Track track;
  for (int i = 0; i < 10; ++i) {
    track.walk(5 + 3 * i);
    track.cut();
  }
  expectBruteForce(track, kShortLags);
}

TEST(MsdAccumulator, CutsOnlyAngularWindowsIfTheHeadingIsAmbiguous) {
  Track track;
  track.walk(50);
  track.cutAngle();
  track.walk(50);
  track.lose(20);
  track.cutAngle();
  track.walk(50);
  expectBruteForce(track, kShortLags);
}

TEST(MsdAccumulator, InterpolatesTheStartOfWindowsAcrossJoins) {
  Track track;
  for (const double gap : {0.3, -0.2, 0.45, 0.1, -0.45, 0.25, 0.8}) {
    track.walk(30);
    track.join(gap);
  }
  track.walk(30);
  track.lose(4);
  track.walk(10);
  expectBruteForce(track, kShortLags);
}

/// A track with all kinds of events, after any number of frames since the last event.
Track eventfulTrack(int events) {
  Track track;
  std::mt19937_64 random(11);
  std::uniform_int_distribution<int> kind(0, 3);
  std::uniform_int_distribution<int> frames(1, 150);
  for (int i = 0; i < events; ++i) {
    track.walk(frames(random));
    switch (kind(random)) {
      case 0:
        track.lose(frames(random));
        break;
      case 1:
        track.cut();
        break;
      case 2:
        track.cutAngle();
        break;
      default:
        track.join(0.001 * frames(random));
        break;
    }
  }
  return track;
}

TEST(MsdAccumulator, AgreesWithBruteForceForAnyEventAtAnyFrame) {
  expectBruteForce(eventfulTrack(100), kShortLags);
}

TEST(MsdAccumulator, GivesTheSameBitsForAnyNumberOfQueries) {
  const std::vector<int> lags{1, 2, 15, 16, 40, 64, 100, 500};
  MsdAccumulator often(lags, kPeriod);
  MsdAccumulator once(lags, kPeriod);
  int asked = 0;
  const Track track = eventfulTrack(100);
  for (const Sample& sample : track.samples()) {
    often.add(sample);
    once.add(sample);
    asked += often.data().tracks.empty() ? 0 : 1;
  }
  EXPECT_EQ(asked, static_cast<int>(track.samples().size()));
  const BlockData a = often.data();
  const BlockData b = once.data();
  EXPECT_EQ(a.lag_times, b.lag_times);
  ASSERT_EQ(a.tracks[0].size(), b.tracks[0].size());
  for (std::size_t block = 0; block < a.tracks[0].size(); ++block) {
    EXPECT_EQ(a.tracks[0][block].forward, b.tracks[0][block].forward);
    for (std::size_t i = 0; i < lags.size(); ++i) {
      const LagSums& x = a.tracks[0][block].lags[i];
      const LagSums& y = b.tracks[0][block].lags[i];
      EXPECT_EQ(x.windows, y.windows);
      EXPECT_EQ(x.r2, y.r2);
      EXPECT_EQ(x.a2, y.a2);
      EXPECT_EQ(x.r4, y.r4);
      EXPECT_EQ(x.a4, y.a4);
    }
  }
}

TEST(MsdAccumulator, IncludesEveryFrameImmediately) {
  Track track;
  track.walk(300);
  MsdAccumulator dut({1, 7, 100}, kPeriod);
  unsigned frames = 0;
  for (const Sample& sample : track.samples()) {
    dut.add(sample);
    ++frames;
    EXPECT_EQ(dut.data().total().lags[0].windows, frames - 1);
    EXPECT_EQ(dut.data().total().lags[1].windows, frames < 7 ? 0 : frames - 7);
    EXPECT_EQ(dut.data().total().steps, frames - 1);
  }
}

TEST(MsdAccumulator, CountsRunsAndTumblesUpToTheLastFrame) {
  MsdAccumulator dut({1, 7}, kPeriod);
  Sample sample;
  for (int i = 0; i < 500; ++i) {
    dut.add(sample);
    if (i == 250) {  // runs between two segments belong to neither
      ++sample.segment;
      ++sample.piece;
      sample.run_time += 5;
      sample.tumble_count += 100;
    }
    sample.free_time += kPeriod;
    sample.run_time += 0.5 * kPeriod;
    sample.tumble_count += i % 10 == 0 ? 1 : 0;
  }
  const BlockSums total = dut.data().total();
  EXPECT_NEAR(total.run_span, 498 * kPeriod, 1e-9);
  EXPECT_NEAR(total.run_time, 0.5 * 498 * kPeriod, 1e-9);
  EXPECT_EQ(total.tumbles, 49);  // one of 50 is between the segments
}

TEST(MsdAccumulator, SkipsTheFrameThatFallsOnTheLastSlotAfterAJoin) {
  Track track;
  track.walk(40);
  track.join(-0.8);  // the first frame after the reversal is only 0.2 periods later
  track.walk(40);
  MsdAccumulator dut({1, 2}, kPeriod);
  for (const Sample& sample : track.samples()) {
    dut.add(sample);
  }
  // 79 samples remain, and no window is counted twice.
  EXPECT_EQ(dut.data().total().lags[0].windows, 78U);
}

TEST(MsdAccumulator, SubsamplesLongLagsWithoutBias) {
  Track track;
  track.walk(60000);
  const std::vector<int> lags{15, 16, 100, 1000};
  MsdAccumulator dut(lags, kPeriod);
  for (const Sample& sample : track.samples()) {
    dut.add(sample);
  }
  const BlockSums total = dut.data().total();
  EXPECT_EQ(total.lags[0].windows, 60000U - 15U);
  for (std::size_t i = 1; i < lags.size(); ++i) {
    const double windows = total.lags[i].windows;
    const double all = 60000 - lags[i];
    EXPECT_GT(windows, 7.9 * all / lags[i]);
    EXPECT_LT(windows, 16.5 * all / lags[i]);
    double every = 0;
    for (std::size_t j = static_cast<std::size_t>(lags[i]); j < 60000; ++j) {
      const Sample& a = track.samples()[j - static_cast<std::size_t>(lags[i])];
      const Sample& b = track.samples()[j];
      every += std::pow(b.x - a.x, 2) + std::pow(b.y - a.y, 2);
    }
    const double recording_error = std::sqrt(2.0 * lags[i] / 3 / 60000);
    EXPECT_NEAR(total.lags[i].r2 / windows / (every / all), 1, 0.25 * recording_error);
  }
}

TEST(MsdAccumulator, LeavesUnobservedLagsWithoutWindows) {
  Track track;
  track.walk(10);
  MsdAccumulator dut({1, 50}, kPeriod);
  for (const Sample& sample : track.samples()) {
    dut.add(sample);
  }
  EXPECT_EQ(dut.data().total().lags[1].windows, 0U);
}

TEST(MsdAccumulator, KeepsTheSumOfTheBlocksWhenTheyAreMerged) {
  Track track;
  track.walk(30000);
  MsdAccumulator dut({1, 7}, kPeriod);
  std::size_t most_blocks = 0;
  for (const Sample& sample : track.samples()) {
    dut.add(sample);
    most_blocks = std::max(most_blocks, dut.data().tracks[0].size());
  }
  EXPECT_LE(most_blocks, BlockStore::kMaxBlocks);
  EXPECT_GE(dut.data().tracks[0].size(), BlockStore::kMaxBlocks / 2);
  EXPECT_NEAR(dut.data().observed(), 29999 * kPeriod, 1e-6);
  EXPECT_EQ(dut.data().total().lags[1].windows, 30000U - 7U);
  const double length = dut.data().tracks[0].front().time;
  for (std::size_t b = 0; b + 1 < dut.data().tracks[0].size(); ++b) {
    EXPECT_NEAR(dut.data().tracks[0][b].time, length, 0.05 * length);
  }
}

TEST(MsdAccumulator, PoolsRobotsAsIndependentBlocks) {
  Track track;
  track.walk(200);
  MsdAccumulator one({1, 7}, kPeriod);
  for (const Sample& sample : track.samples()) {
    one.add(sample);
  }
  BlockData pool;
  pool.pool(one.data());
  pool.pool(one.data());
  EXPECT_EQ(pool.tracks.size(), 2U);
  EXPECT_NEAR(pool.observed(), 2 * one.data().observed(), 1e-9);
  const BlockSums total = pool.total();
  EXPECT_EQ(total.lags[1].windows, 2 * one.data().total().lags[1].windows);
  EXPECT_NEAR(pool.lagTime(1, total), 7 * kPeriod, 1e-9);
}

TEST(MsdAccumulator, MeasuresTheStepsAlongAndAcrossTheHeading) {
  MsdAccumulator dut({1}, kPeriod);
  Sample sample;
  sample.theta = 0.7;
  for (int i = 0; i < 101; ++i) {
    const double along = 0.001 * i;
    const double across = 0.0002 * (i % 2);
    sample.x = along * std::cos(0.7) - across * std::sin(0.7);
    sample.y = along * std::sin(0.7) + across * std::cos(0.7);
    dut.add(sample);
    sample.free_time += kPeriod;
  }
  const BlockSums total = dut.data().total();
  EXPECT_NEAR(total.forward, 0.1, 1e-12);
  EXPECT_NEAR(total.forward_time, 100 * kPeriod, 1e-12);
  EXPECT_NEAR(total.sideways2 / total.steps, 0.0002 * 0.0002, 1e-15);
}

TEST(MsdAccumulator, WindowsOfLongLagsHaveTheExactLengthAcrossLostFramesAndJoins) {
  // At constant velocity all windows of a lag have the same displacement, so a window that is a
  // frame too long or too short is detected.
  Track track;
  for (int i = 0; i < 400; ++i) {
    track.walk(37 + i % 11);
    track.join(0.09 * (i % 10) - 0.4);
    track.walk(20);
    track.lose(i % 3);
  }
  const std::vector<int> lags{1, 15, 16, 40, 63, 64, 99, 500, 3001};
  MsdAccumulator dut(lags, kPeriod);
  for (Sample sample : track.samples()) {
    sample.x = 0.03 * sample.free_time;
    sample.y = 0;
    sample.theta = 0.7 * sample.free_time;
    dut.add(sample);
  }
  const BlockData data = dut.data();
  const BlockSums total = data.total();
  for (std::size_t i = 0; i < lags.size(); ++i) {
    const LagSums& sums = total.lags[i];
    const double tau = data.lagTime(i, total);
    const auto n = static_cast<double>(sums.windows);
    EXPECT_GT(n, 0.6 * static_cast<double>(track.samples().size()) / std::max(1.0, lags[i] / 7.9));
    EXPECT_EQ(sums.angular_windows, sums.windows);
    EXPECT_NEAR(tau / (lags[i] * kPeriod), 1, 1e-3) << lags[i];
    EXPECT_NEAR(sums.r2 / n / std::pow(0.03 * tau, 2), 1, 1e-6) << lags[i];
    EXPECT_NEAR(sums.a2 / n / std::pow(0.7 * tau, 2), 1, 1e-6) << lags[i];
    EXPECT_NEAR(sums.r4 * n / (sums.r2 * sums.r2), 1, 1e-6) << lags[i];
  }
}

/// A reversal may last a whole number of frames: then windows across it end exactly at a frame.
TEST(MsdAccumulator, LosesNoWindowOfLongLagsIfReversalsLastWholeFrames) {
  const std::vector<int> lags{1, 70, 100, 150, 316, 500};
  constexpr double kTenth = 0.1;  // s
  const auto windows = [&](double gap) {
    MsdAccumulator dut(lags, kTenth);
    Sample sample;
    for (int i = 0; i < 38000; ++i) {
      sample.piece = i / 641;
      sample.free_time = kTenth * (i + gap * sample.piece);
      dut.add(sample);
    }
    return dut.data().total();
  };
  const BlockSums in_step = windows(0);
  const BlockSums between = windows(0.37);

  for (std::size_t i = 1; i < lags.size(); ++i) {
    // Of some 38 000 frames every (lag/16 to lag/8)-th begins a window.
    EXPECT_GT(in_step.lags[i].windows, 8 * 37000 / lags[i]);
    EXPECT_NEAR(in_step.lags[i].windows, between.lags[i].windows, 60) << lags[i];
  }
}

TEST(MsdAccumulator, KeepsAnHourAtHundredFramesASecondInLessThan50kB) {
  const ProgramLaw law = abpLaw(3, 0.5);
  MsdAccumulator dut(makeLagGrid(0.01, 100, law), 0.01);
  Sample sample;
  for (int i = 0; i < 360000; ++i) {
    sample.free_time = 0.01 * i;
    dut.add(sample);
  }
  EXPECT_LT(dut.memoryBytes(), 50000U);
}

TEST(BlockStore, PacksBlocksWithoutLosingTheirDifferences) {
  Track track;
  track.walk(20000);
  MsdAccumulator dut({1, 7, 100}, kPeriod);
  for (const Sample& sample : track.samples()) {
    dut.add(sample);
  }
  const BlockData data = dut.data();
  // A lag of one frame: every step of the walk is in one block, and nowhere else.
  std::size_t at = 0;
  const BlockTrack& blocks = data.tracks[0];
  for (std::size_t b = 0; b + 1 < blocks.size(); ++b) {
    const auto steps = static_cast<std::size_t>(std::lround(blocks[b].time / kPeriod));
    double r2 = 0;
    for (std::size_t i = at; i < at + steps && i + 1 < track.samples().size(); ++i) {
      r2 += std::pow(track.samples()[i + 1].x - track.samples()[i].x, 2) +
            std::pow(track.samples()[i + 1].y - track.samples()[i].y, 2);
    }
    at += steps;
    const LagSums& lag = blocks[b].lags[0];
    EXPECT_NEAR(lag.windows, static_cast<double>(steps), 0.03 * static_cast<double>(steps));
    EXPECT_NEAR(lag.r2 / lag.windows / (r2 / static_cast<double>(steps)), 1, 2e-2);
    EXPECT_NEAR(lag.r4 * lag.windows / (lag.r2 * lag.r2), 2, 0.5);
  }
}

}  // namespace
}  // namespace lab::analysis::msd_accumulator_test
