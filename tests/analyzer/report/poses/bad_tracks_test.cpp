// Errors of trackers and clocks in files of poses: results are unbiased, or the file is rejected
// with a reason.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "analyzer/report/poses/pose_run.hpp"
#include "analyzer/report_error.hpp"
#include "tests/analyzer/paper_programs.hpp"
#include "tests/analyzer/recording_ensemble.hpp"

namespace lab::report {
namespace {

using analysis::TrackPoint;
using analysis::WalkerRecording;
using testing::HasSubstr;

/// Changes the points of a recording in place; may erase some.
using Damage = std::function<void(std::vector<TrackPoint>&, std::mt19937_64&)>;

std::string csvOf(const std::vector<TrackPoint>& points) {
  std::ostringstream text;
  text.precision(12);
  text << "frame,particle,x,y,theta,t\n";
  for (const TrackPoint& point : points) {
    text << point.frame << ",1," << point.x * 100 << ',' << point.y * 100 << ',' << point.theta
         << ',' << point.time << '\n';
  }
  return text.str();
}

std::vector<TrackPoint> recorded(double duration, unsigned seed) {
  WalkerRecording recording;
  recording.law = analysis::abpLaw(3, 0.5);
  recording.duration = duration;
  recording.fps = 19.7;
  recording.sigma = 0.0005;
  recording.sigma_theta = 0.0175;
  recording.seed = seed;
  std::vector<TrackPoint> points;
  analysis::Walker walker(recording);
  walker.on_frame = [&](const TrackPoint& point) { points.push_back(point); };
  walker.on_telemetry = [](const analysis::RobotTelemetry&) {};
  walker.run();
  return points;
}

RunRecord analysed(const std::string& csv, analysis::Depth depth = analysis::Depth::kLive) {
  std::istringstream text(csv);
  return poseRun(readPoses(text, "poses.csv", {.scale = 0.01, .fps = {}}), "poses",
                 {"abp", {"v_cm_s=3", "epsilon_s=0.5", "eta_rad_s=3", "analysis.max_lag_s=20"}},
                 {depth});
}

const analysis::Estimate& numberOf(const RunRecord& record, std::string_view name) {
  const analysis::Estimate* found = nullptr;
  for (const analysis::Estimate& estimate : record.results.front().result.estimates) {
    if (estimate.name == name) found = &estimate;
  }
  if (found == nullptr) throw std::logic_error("no estimate of " + std::string(name));
  return *found;
}

std::string refusal(const std::string& csv) {
  try {
    static_cast<void>(analysed(csv));
  } catch (const ReportError& error) {
    return error.what();
  }
  return "none";
}

/// Mean over recordings against the exact law with the tracker's noise.
void expectUnbiased(const Damage& damage) {
  constexpr int kRecordings = 16;
  std::map<double, std::pair<analysis::Scatter, double>> lags[2];
  std::map<std::string, analysis::Scatter> numbers;
  for (unsigned seed = 0; seed < kRecordings; ++seed) {
    std::vector<TrackPoint> points = recorded(300, 600 + seed);
    std::mt19937_64 random(seed);
    damage(points, random);
    const RunRecord record = analysed(csvOf(points));
    ASSERT_FALSE(record.results.empty());
    for (const char* name : {"v", "D_r"}) {
      const analysis::Estimate& estimate = numberOf(record, name);
      numbers[name].add(estimate.value / estimate.theory);
    }
    const analysis::Curves& curves = record.results.front().result.curves;
    for (const bool angular : {false, true}) {
      for (const analysis::CurvePoint& point : angular ? curves.angular_msd : curves.msd) {
        if (point.windows == 0) {
          EXPECT_TRUE(std::isnan(point.value)) << point.tau;
          continue;
        }
        EXPECT_GT(point.value, 0) << point.tau;
        auto& [scatter, exact] = lags[angular][std::round(point.tau * 1000)];
        scatter.add(point.value);
        exact = point.exact + (angular ? 2 * 0.0175 * 0.0175 : 4 * 0.0005 * 0.0005);
      }
    }
  }
  for (const auto& [name, scatter] : numbers) {
    EXPECT_EQ(scatter.n, kRecordings) << name;
    EXPECT_LT(std::abs(scatter.z(1)), 4) << name << ": " << scatter.mean() << " of the truth";
  }
  for (const bool angular : {false, true}) {
    int judged = 0;
    for (const auto& [tau, lag] : lags[angular]) {
      if (lag.first.n < kRecordings) continue;
      ++judged;
      EXPECT_LT(std::abs(lag.first.z(lag.second)), 4)
          << (angular ? "angular MSD" : "MSD") << " at " << tau
          << " ms: " << lag.first.mean() / lag.second;
    }
    EXPECT_GT(judged, 10);
  }
}

/// The fit of the exact law to one damaged recording of ten minutes: its error bars cover the
/// truth.
void expectFit(const Damage& damage) {
  std::vector<TrackPoint> points = recorded(600, 77);
  std::mt19937_64 random(5);
  damage(points, random);
  const RunRecord record = analysed(csvOf(points), analysis::Depth::kFull);
  for (const char* name : {"v", "D_r"}) {
    const analysis::Estimate& estimate = numberOf(record, name);
    ASSERT_GT(estimate.sigma, 0) << name;
    EXPECT_LT(std::abs(estimate.value - estimate.theory) / estimate.sigma, 4) << name;
    EXPECT_LT(estimate.sigma, 0.12 * estimate.theory) << name << ": the error bar is too large";
  }
  EXPECT_NE(record.results.front().result.verdict.kind, analysis::VerdictKind::kDisagrees);
}

TEST(BadTrack, UndamagedTrack) {
  expectUnbiased([](auto&, auto&) {});
  expectFit([](auto&, auto&) {});
}

TEST(BadTrack, OnePercentOfFramesMissing) {
  const Damage damage = [](std::vector<TrackPoint>& points, std::mt19937_64& random) {
    std::bernoulli_distribution lost(0.01);
    std::erase_if(points, [&](const TrackPoint&) { return lost(random); });
  };
  expectUnbiased(damage);
  expectFit(damage);
}

TEST(BadTrack, FivePercentOfPosesMisplaced) {
  const Damage damage = [](std::vector<TrackPoint>& points, std::mt19937_64& random) {
    std::bernoulli_distribution bad(0.05);
    std::uniform_real_distribution<double> away(-0.5, 0.5);
    std::uniform_real_distribution<double> turn(-std::numbers::pi, std::numbers::pi);
    for (TrackPoint& point : points) {
      if (!bad(random)) continue;
      point.x += away(random);
      point.y += away(random);
      point.theta = turn(random);
    }
  };
  expectUnbiased(damage);
  expectFit(damage);
}

TEST(BadTrack, HeadAndTailConfused) {
  const Damage damage = [](std::vector<TrackPoint>& points, std::mt19937_64& random) {
    std::bernoulli_distribution single(0.01);
    for (TrackPoint& point : points) {
      const bool stretch = point.time > 50 && point.time < 90;
      if (single(random) == stretch) continue;
      point.theta = std::remainder(point.theta + std::numbers::pi, 2 * std::numbers::pi);
    }
  };
  expectUnbiased(damage);
  expectFit(damage);
}

TEST(BadTrack, InvalidNumbers) {
  const Damage damage = [](std::vector<TrackPoint>& points, std::mt19937_64& random) {
    std::bernoulli_distribution bad(0.02);
    for (TrackPoint& point : points) {
      if (bad(random)) point.x = std::numeric_limits<double>::quiet_NaN();
      if (bad(random)) point.theta = std::numeric_limits<double>::infinity();
    }
  };
  expectUnbiased(damage);
  expectFit(damage);
}

TEST(BadTrack, TimeStampsRepeatedAndReordered) {
  const Damage damage = [](std::vector<TrackPoint>& points, std::mt19937_64& random) {
    std::bernoulli_distribution bad(0.005);
    for (std::size_t i = 2; i < points.size(); ++i) {
      if (bad(random)) points[i].time = points[i - 1].time;
      if (bad(random)) points[i].time = points[i - 2].time;
    }
  };
  expectUnbiased(damage);
  expectFit(damage);
}

TEST(BadTrack, RowsInAnyOrder) {
  expectUnbiased([](std::vector<TrackPoint>& points, std::mt19937_64& random) {
    std::shuffle(points.begin(), points.end(), random);
  });
}

TEST(BadTrack, StepsOfTheClock) {
  const Damage forward = [](std::vector<TrackPoint>& points, std::mt19937_64&) {
    for (TrackPoint& point : points) point.time += point.time > 100 ? 30 : 0;
  };
  const Damage back = [](std::vector<TrackPoint>& points, std::mt19937_64&) {
    for (TrackPoint& point : points) point.time -= point.time > 100 ? 10 : 0;
  };
  expectUnbiased(forward);
  expectUnbiased(back);

  std::vector<TrackPoint> points = recorded(200, 1);
  std::mt19937_64 random;
  forward(points, random);
  const RunRecord record = analysed(csvOf(points));
  EXPECT_EQ(record.poses->clock_steps, 1);
  EXPECT_EQ(record.results.front().result.segments, 2);
}

TEST(BadTrack, StoppedClockIsRejected) {
  std::vector<TrackPoint> points = recorded(20, 1);
  for (TrackPoint& point : points) point.time = std::floor(point.time);
  EXPECT_THAT(refusal(csvOf(points)), HasSubstr("expected more than in the frames before it"));
}

TEST(BadTrack, TwoMinutesOnly) {
  const RunRecord record = analysed(csvOf(recorded(120, 4)));
  for (const analysis::CurvePoint& point : record.results.front().result.curves.msd) {
    EXPECT_TRUE(point.windows > 0 ? point.value > 0 && point.sigma > 0 : std::isnan(point.value));
  }
}

TEST(BadTrack, TwoMinutesHaveCorrectErrors) {
  const RunRecord record = analysed(csvOf(recorded(120, 4)), analysis::Depth::kFull);
  for (const char* name : {"v", "D_r"}) {
    const analysis::Estimate& estimate = numberOf(record, name);
    EXPECT_LE(estimate.low95, estimate.theory) << name;
    EXPECT_GE(estimate.high95, estimate.theory) << name;
  }
}

TEST(BadTrack, SingleFrameIsRejected) {
  EXPECT_THAT(refusal("frame,particle,x,y,theta,t\n0,1,1,1,0,0\n"),
              HasSubstr("a single picture has no motion"));
}

TEST(BadTrack, OnlyNanIsRejected) {
  EXPECT_THAT(refusal("frame,particle,x,y,theta,t\n0,1,nan,1,0,0\n1,1,nan,1,0,0.1\n"),
              HasSubstr("found no pose in 2 rows"));
}

TEST(BadTrack, RobotAtRestIsNotTheProgram) {
  std::vector<TrackPoint> points = recorded(60, 1);
  std::mt19937_64 random(2);
  std::normal_distribution<double> noise(0, 5e-4);
  for (TrackPoint& point : points) {
    point.x = 0.3 + noise(random);
    point.y = 0.3 + noise(random);
    point.theta = 1 + 30 * noise(random);
  }
  const RunRecord record = analysed(csvOf(points));
  EXPECT_EQ(record.results.front().result.verdict.kind, analysis::VerdictKind::kDisagrees);
  for (const analysis::Estimate& estimate : record.results.front().result.estimates) {
    if (estimate.name != "v") continue;
    EXPECT_LT(std::abs(estimate.value), 0.001);
  }
}

}  // namespace
}  // namespace lab::report
