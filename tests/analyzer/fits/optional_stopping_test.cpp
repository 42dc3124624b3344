// The effect on intervals if a run ends when an estimate is precise enough: recordings that end by
// the rule of stop_when, checked as often as in the lab (or every 5 s).
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>

#include "tests/analyzer/paper_programs.hpp"
#include "tests/analyzer/recording_ensemble.hpp"

namespace lab::analysis::optional_stopping_test {
namespace {

constexpr int kRecordings = 300;

ProgramLaw figure2b() { return abpLaw(3, 0.5); }

Estimate rotational(const ProgramAnalysis& analysis) {
  for (const Estimate& estimate : estimate(analysis.law(), analysis.data())) {
    if (estimate.name == "D_r") return estimate;
  }
  return {};
}

/// Coverage of the intervals of recordings.
struct Coverage {
  Scatter value;
  Scatter length;
  int recordings = 0;
  int covered = 0;
  int missed_low = 0;  ///< The truth is above the interval.

  void add(const Estimate& estimate, double seconds) {
    value.add(estimate.value / estimate.theory);
    length.add(seconds);
    ++recordings;
    covered += estimate.low95 <= estimate.theory && estimate.theory <= estimate.high95 ? 1 : 0;
    missed_low += estimate.high95 < estimate.theory ? 1 : 0;
  }
  [[nodiscard]] double share() const { return static_cast<double>(covered) / recordings; }
  void print(const char* what) const {
    std::printf(
        "%-34s %d recordings, %.0f +- %.0f s: bias %+.2f +- %.2f %%, covered %.1f %%, "
        "too low in %.1f %%\n",
        what, recordings, length.mean(), length.deviation(), 100 * (value.mean() - 1),
        100 * value.deviation() / std::sqrt(value.n), 100 * share(),
        100.0 * missed_low / recordings);
  }
};

struct Stopped {
  Coverage by_rule;
  Coverage fixed;  ///< Recordings of the mean length of the others.
};

/// @param every s between two looks at the estimate
/// @param fixed length of the recordings that end by the clock, s
Stopped measure(double wanted, double at_least, double longest, double every, double fixed) {
  Stopped result;
  for (int i = 0; i < kRecordings; ++i) {
    WalkerRecording recording;
    recording.law = figure2b();
    recording.duration = longest;
    recording.fps = 10.07;
    recording.sigma_theta = 0.01;
    recording.sigma = 0.0005;
    recording.seed = 7000 + static_cast<std::uint64_t>(i);
    const StitchedRecording stitched = stitch(recording);
    ProgramAnalysis analysis(recording.law, 1 / recording.fps, 100);
    double next = every;
    std::optional<Estimate> stopped;
    std::optional<Estimate> ended;
    double when = longest;
    for (const Sample& sample : stitched.samples) {
      analysis.add(sample);
      if (sample.time < next) continue;
      next += every;
      if (!ended && sample.time >= fixed) ended = rotational(analysis);
      if (stopped || sample.time < at_least) continue;
      const Estimate now = rotational(analysis);
      if (!std::isfinite(now.value) || !(now.sigma > 0)) continue;
      if (now.sigma > wanted * std::abs(now.value)) continue;
      stopped = now;
      when = sample.time;
      if (ended) break;
    }
    result.by_rule.add(stopped.value_or(rotational(analysis)), when);
    if (ended) result.fixed.add(*ended, fixed);
  }
  return result;
}

TEST(OptionalStopping, NearlyKeepsTheCoverageOfIntervals) {
  const Stopped ten = measure(0.10, 0, 500, 1, 160);
  ten.by_rule.print("D_r to 10 %");
  std::fflush(stdout);
  ten.fixed.print("by the clock");
  const Stopped later = measure(0.10, 120, 500, 1, 160);
  later.by_rule.print("D_r to 10 %, at_least_s = 120");
  const Stopped five = measure(0.05, 0, 1200, 5, 630);
  five.by_rule.print("D_r to 5 %");
  five.fixed.print("by the clock");
  // The rule selects recordings that scatter little by chance.
  EXPECT_GT(ten.by_rule.share(), 0.87);
  EXPECT_GT(five.by_rule.share(), 0.90);
  EXPECT_LT(std::abs(ten.by_rule.value.mean() - 1), 0.05);
  EXPECT_LT(std::abs(five.by_rule.value.mean() - 1), 0.025);
}

}  // namespace
}  // namespace lab::analysis::optional_stopping_test
