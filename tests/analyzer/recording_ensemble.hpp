#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "analyzer/curves/statistics.hpp"
#include "analyzer/service/program_analysis.hpp"
#include "tests/analyzer/walker.hpp"

namespace lab::analysis {

/// The stitched samples of a recording.
struct StitchedRecording {
  std::vector<Sample> samples;
  StitcherCounters counters;
  ProgramTally tally;
};

/// Removes a second now and then; no window crosses the gap.
inline void cut(std::vector<Sample>& samples, double every, std::mt19937_64& random) {
  std::exponential_distribution<double> wait(1 / every);
  double next = wait(random);
  int cuts = 0;
  std::vector<Sample> left;
  for (Sample sample : samples) {
    while (sample.time > next + 1) {
      next += 1 + wait(random);
      ++cuts;
    }
    if (sample.time > next) continue;
    sample.segment += cuts;
    sample.angular_segment += cuts;
    sample.piece += cuts;
    sample.free_time -= cuts;
    left.push_back(sample);
  }
  samples = std::move(left);
}

inline StitchedRecording stitch(const WalkerRecording& recording) {
  StitchedRecording result;
  TrackStitcher stitcher{StitcherConfig{}};
  Walker walker(recording);
  std::mt19937_64 random(recording.seed + 1);
  std::uniform_real_distribution<double> uniform(0, 1);
  bool is_lost = false;
  walker.on_frame = [&](const TrackPoint& point) {
    const double stays = 1 - 1 / recording.missing_length;
    const double begins = recording.missing / (1 - recording.missing) / recording.missing_length;
    is_lost = uniform(random) < (is_lost ? stays : begins);
    if (!is_lost) stitcher.addFrame(point, result.samples);
  };
  walker.on_telemetry = [&](const RobotTelemetry& telemetry) {
    stitcher.addTelemetry(telemetry, result.samples);
  };
  walker.run();
  stitcher.flush(result.samples);
  if (recording.cut_every > 0) cut(result.samples, recording.cut_every, random);
  result.counters = stitcher.counters();
  result.tally = stitcher.tally(0);
  return result;
}

inline ProgramResult analyseRecording(const WalkerRecording& recording,
                                      const StitchedRecording& stitched, double max_lag = 100) {
  ProgramAnalysis analysis(recording.law, 1 / recording.fps, max_lag);
  for (const Sample& sample : stitched.samples) {
    analysis.add(sample);
  }
  return analyse(recording.law, analysis.data(), stitched.tally, CurveOptions{});
}

/// Mean and scatter of one number over recordings.
struct Scatter {
  double n = 0;
  double sum = 0;
  double sum2 = 0;

  void add(double x) {
    if (std::isfinite(x)) {
      n += 1;
      sum += x;
      sum2 += x * x;
    }
  }
  [[nodiscard]] double mean() const { return sum / n; }
  [[nodiscard]] double deviation() const { return std::sqrt((sum2 - sum * sum / n) / (n - 1)); }
  /// The deviation of the mean from `expected`, as a normal deviate (by Student's t, because the
  /// scatter of few recordings is uncertain).
  [[nodiscard]] double z(double expected) const {
    return normalDeviate((mean() - expected) / (deviation() / std::sqrt(n)), n - 1);
  }
};

/// One lag over an ensemble of recordings.
struct LagScatter {
  double tau = 0;
  double exact = 0;
  Scatter value;
  Scatter sigma;
};

struct EnsembleCurves {
  std::vector<LagScatter> msd;
  std::vector<LagScatter> angular;

  void add(const ProgramResult& result) {
    addCurve(result.curves.msd, msd);
    addCurve(result.curves.angular_msd, angular);
  }

 private:
  static void addCurve(const std::vector<CurvePoint>& points, std::vector<LagScatter>& lags) {
    lags.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      lags[i].tau = points[i].tau;
      lags[i].exact = points[i].exact;
      lags[i].value.add(points[i].value);
      lags[i].sigma.add(points[i].sigma);
    }
  }
};

/// Expects that every lag that all recordings observed follows the exact law.
inline void expectUnbiased(const std::vector<LagScatter>& lags, double recordings,
                           const char* what) {
  for (const LagScatter& lag : lags) {
    if (lag.value.n == recordings) {
      EXPECT_LT(std::abs(lag.value.z(lag.exact)), 4)
          << what << " at " << lag.tau << " s: " << lag.value.mean() / lag.exact;
    }
  }
}

/// The coverage of the 95 % interval of each estimate, and its bias.
struct Coverage {
  int recordings = 0;
  std::map<std::string, int> covered;
  std::map<std::string, Scatter> value;
  std::map<std::string, Scatter> sigma;
  std::map<std::string, double> theory;
  int disagreements = 0;
  EnsembleCurves curves;

  [[nodiscard]] double share(const std::string& name) const {
    return static_cast<double>(covered.at(name)) / recordings;
  }
};

inline Coverage cover(WalkerRecording recording, int recordings, double max_lag) {
  Coverage result;
  result.recordings = recordings;
  for (int i = 0; i < recordings; ++i) {
    recording.seed = 7000U + static_cast<unsigned>(i);
    const ProgramResult analysed = analyseRecording(recording, stitch(recording), max_lag);
    for (const Estimate& estimate : analysed.estimates) {
      const bool inside = estimate.low95 <= estimate.theory && estimate.theory <= estimate.high95;
      result.covered[estimate.name] += inside ? 1 : 0;
      result.value[estimate.name].add(estimate.value);
      result.sigma[estimate.name].add(estimate.sigma);
      result.theory[estimate.name] = estimate.theory;
    }
    result.disagreements += analysed.verdict.kind == VerdictKind::kDisagrees ? 1 : 0;
    result.curves.add(analysed);
  }
  return result;
}

/// 90 to 97 %, or the binomial 3-sigma band around 95 % if that is wider.
inline void expectCoverage(const Coverage& coverage, const std::string& name) {
  const double band = 3 * std::sqrt(0.95 * 0.05 / coverage.recordings);
  EXPECT_GT(coverage.share(name), std::min(0.90, 0.95 - band)) << name;
  EXPECT_LT(coverage.share(name), std::max(0.97, 0.95 + band)) << name;
}

/// Block errors over true scatter, lag by lag up to recording / 180, and on average.
inline void expectTrueErrors(const std::vector<LagScatter>& lags, double recording) {
  Scatter ratios;
  for (const LagScatter& lag : lags) {
    if (lag.tau <= recording / 180) {
      const double ratio = lag.sigma.mean() / lag.value.deviation();
      // The standard deviation of n recordings is uncertain.
      const double slack = 2 / std::sqrt(2 * lag.value.n);
      EXPECT_GT(ratio, 0.9 * (1 - slack)) << lag.tau;
      EXPECT_LT(ratio, 1.15 * (1 + slack)) << lag.tau;
      ratios.add(ratio);
    }
  }
  ASSERT_GT(ratios.n, 10);
  EXPECT_GT(ratios.mean(), 0.9);
  EXPECT_LT(ratios.mean(), 1.15);
}

/// A short recording with the noise of a good tracker.
inline WalkerRecording shortRecording(const ProgramLaw& law) {
  WalkerRecording recording;
  recording.law = law;
  recording.duration = 120;
  recording.sigma = 0.0005;
  recording.sigma_theta = 0.025;
  return recording;
}

}  // namespace lab::analysis
