#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analyzer/curves/curves.hpp"
#include "analyzer/curves/estimates.hpp"
#include "analyzer/curves/hold_period.hpp"
#include "analyzer/curves/join_comparison.hpp"
#include "analyzer/curves/msd_accumulator.hpp"
#include "analyzer/curves/whole_motion.hpp"
#include "analyzer/fits/kurtosis_hypothesis.hpp"
#include "analyzer/fits/law_fit.hpp"
#include "analyzer/laws.hpp"
#include "analyzer/runs/run_statistics.hpp"
#include "analyzer/tracks/track_stitcher.hpp"

namespace lab::analysis {

/// Extent of the analysis.
enum class Depth {
  kLive,  ///< What the sums give directly: curves, block errors, estimates. Used online and
          ///< offline.
  kFull,  ///< Also what needs simulated recordings: fits of the exact law and their intervals.
};

inline constexpr int kPool = -1;  ///< Robot number of the pool of all robots that ran the program.

/// The results for one program of one robot, or of all robots; SI units.
struct ProgramResult {
  int robot = kPool;
  int robots = 0;  ///< Number of robots.
  ProgramLaw law;
  double observed = 0;       ///< Free time used, s.
  std::int64_t samples = 0;  ///< Frames used.
  std::int64_t lost = 0;     ///< Frames dropped for missing telemetry or as outliers.
  std::int64_t segments = 0;
  std::int64_t reversals = 0;  ///< Removed and joined.
  double contact_share = 0;    ///< Share of the program's frames cut for contacts.
  TimeShares shares;
  std::optional<WholeMotion> whole;  ///< If AnalysisConfig::whole_motion is set.
  double unbiased_lag = 0;           ///< Longer lags are selected by the light, s; 0: none.
  Curves curves;
  std::vector<Estimate> estimates;
  Verdict verdict;
  std::string no_verdict;  ///< Why there cannot be a verdict (yet), a sentence; empty: there can.
  std::optional<LawFit> fit;            ///< At Depth::kFull, for programs with a law.
  std::optional<JoinComparison> joins;  ///< If AnalysisConfig::compare_joins is set.
  std::optional<RunStatistics> runs;    ///< Of runs and turns, if AnalysisConfig::find_runs is set.
  std::optional<KurtosisTest> kurtosis;  ///< If the law gives one, at Depth::kFull.
};

/// A live result, and what it depends on: it is computed anew only if that has changed.
struct LiveResult {
  std::int64_t samples = 0;  ///< Number of them; 0: there is no result yet.
  double unbiased_lag = 0;   ///< s
  bool judged = false;       ///< With the simulated reference, if the law needs one.
  ProgramResult result;

  [[nodiscard]] bool isOf(std::int64_t samples_now, double unbiased_lag_now,
                          bool judged_now) const {
    return samples == samples_now && unbiased_lag == unbiased_lag_now && judged == judged_now;
  }
};
/// Sets the verdict of the result from its curves, and from the p-values of its fit if it has one.
/// There is none if robots were in contact most of the time, because the rest is a biased sample.
void judgeMotion(ProgramResult& result);

/// A smaller p-value of the fit, or of the test of the programmed law, is a deviation. Together
/// with the largest |z| fewer than one recording of the true law in a hundred is called so.
inline constexpr double kUnlikely = 0.001;

/// A larger share of contacts leaves no verdict.
inline constexpr double kMostlyContact = 0.5;

/// Accumulates the samples of one program of one robot.
class ProgramAnalysis {
 public:
  /// The longest lag and the nominal frame period in s.
  ProgramAnalysis(const ProgramLaw& law, double frame_period, double max_lag);

  /// Enables the comparison of windows within pieces with all windows. Call it before the first
  /// sample.
  void collectJoins(double frame_period, double max_lag) { joins_.emplace(frame_period, max_lag); }

  /// Enables the search for runs, if the program has any. Call it before the first sample.
  void collectRuns(double frame_period) {
    if (law_->runs()) runs_.emplace(law_, frame_period);
  }

  /// Enables the whole motion. Call it before the first sample.
  void collectWhole(double frame_period, double max_lag);

  /// Takes a frame for the whole motion, if that is enabled.
  void addFrame(const FrameReport& frame) {
    if (whole_) whole_->add(frame);
  }

  void add(const Sample& sample) {
    ++samples_;
    accumulator_.add(sample);
    if (joins_) joins_->add(sample);
    if (runs_) runs_->add(sample);
    if (holds_) holds_->add(sample);
  }

  /// The blocks so far; valid until the next sample.
  [[nodiscard]] const BlockData& data() const {
    if (!data_ || data_samples_ != samples_) {
      data_ = accumulator_.data();
      if (holds_) data_->holds = holds_->spectra();
      data_samples_ = samples_;
    }
    return *data_;
  }
  [[nodiscard]] std::int64_t samples() const { return samples_; }  ///< Number of them so far.
  /// The last live result of this robot, for its owner.
  [[nodiscard]] LiveResult& live() const { return live_; }
  [[nodiscard]] const ProgramLaw& law() const { return law_; }
  /// nullopt: not enabled.
  [[nodiscard]] const std::optional<JoinAccumulator>& joins() const { return joins_; }
  [[nodiscard]] const std::optional<RunFinder>& runs() const { return runs_; }
  [[nodiscard]] const std::optional<WholeAccumulator>& whole() const { return whole_; }

 private:
  ProgramLaw law_;
  MsdAccumulator accumulator_;
  std::int64_t samples_ = 0;
  mutable std::optional<BlockData> data_;
  mutable std::int64_t data_samples_ = 0;  ///< Number of samples in data_.
  mutable LiveResult live_;
  std::optional<JoinAccumulator> joins_;
  std::optional<RunFinder> runs_;
  std::optional<HoldPeriodFinder> holds_;
  std::optional<WholeAccumulator> whole_;
};

/// Sets the counts of frames, segments and reversals.
void setTally(ProgramResult& result, const ProgramTally& tally);

/// Curves, estimates and verdict of block data. `tally` is the sum over its robots.
[[nodiscard]] ProgramResult analyse(const ProgramLaw& law, const BlockData& data,
                                    const ProgramTally& tally, const CurveOptions& options,
                                    Depth depth = Depth::kLive);

}  // namespace lab::analysis
