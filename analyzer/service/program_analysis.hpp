#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "analyzer/curves/curves.hpp"
#include "analyzer/curves/estimates.hpp"
#include "analyzer/curves/join_comparison.hpp"
#include "analyzer/curves/msd_accumulator.hpp"
#include "analyzer/fits/brownian_hypothesis.hpp"
#include "analyzer/fits/law_fit.hpp"
#include "analyzer/laws.hpp"
#include "analyzer/runs/run_statistics.hpp"
#include "analyzer/tracks/track_stitcher.hpp"

namespace lab::analysis {

/// How much is made of the data.
enum class Depth {
  kLive,  ///< What sums give at once: curves, block errors, estimates. Online and offline alike.
  kFull,  ///< Besides, what needs simulated recordings: fits of the exact law and their intervals.
};

inline constexpr int kPool = -1;  ///< In place of a robot: all robots that ran the program.

/// All that is known about one program of one robot, or of all robots; SI units.
struct ProgramResult {
  int robot = kPool;
  int robots = 0;  ///< How many are in it.
  ProgramLaw law;
  double observed = 0;       ///< Free time that went in, s.
  std::int64_t samples = 0;  ///< Frames that went in.
  std::int64_t lost = 0;     ///< Frames lost to missing telemetry or as outliers.
  std::int64_t segments = 0;
  std::int64_t reversals = 0;  ///< Removed and joined.
  double contact_share = 0;    ///< Share of the program's frames cut for contacts.
  double unbiased_lag = 0;     ///< Longer lags are selected by the light, s; 0: none is.
  Curves curves;
  std::vector<Estimate> estimates;
  Verdict verdict;
  std::optional<LawFit> fit;            ///< At Depth::kFull, of programs with a law.
  std::optional<JoinComparison> joins;  ///< Where AnalysisConfig::compare_joins asks for it.
  std::optional<RunStatistics> runs;    ///< Of an RTP, where AnalysisConfig::find_runs asks for it.
  std::optional<BrownianTest> brownian;  ///< Of a BP, at Depth::kFull.
};

/// One program of one robot: takes its samples, gives its statistics.
class ProgramAnalysis {
 public:
  /// The longest lag and the nominal frame period in s.
  ProgramAnalysis(const ProgramLaw& law, double frame_period, double max_lag);

  /// Also compares windows within pieces with all; to be said before the first sample.
  void collectJoins(double frame_period, double max_lag) { joins_.emplace(frame_period, max_lag); }

  /// Also finds the runs of an RTP; to be said before the first sample.
  void collectRuns(double frame_period) {
    if (law_.kind == ProgramKind::kRtp) runs_.emplace(law_, frame_period);
  }

  void add(const Sample& sample) {
    accumulator_.add(sample);
    if (joins_) joins_->add(sample);
    if (runs_) runs_->add(sample);
  }

  [[nodiscard]] BlockData data() const { return accumulator_.data(); }
  [[nodiscard]] const ProgramLaw& law() const { return law_; }
  /// Nothing: not watched.
  [[nodiscard]] const std::optional<JoinAccumulator>& joins() const { return joins_; }
  [[nodiscard]] const std::optional<RunFinder>& runs() const { return runs_; }

 private:
  ProgramLaw law_;
  MsdAccumulator accumulator_;
  std::optional<JoinAccumulator> joins_;
  std::optional<RunFinder> runs_;
};

/// Curves, estimates and verdict of block data; the tally of its robots is added up by the caller.
[[nodiscard]] ProgramResult analyse(const ProgramLaw& law, const BlockData& data,
                                    const ProgramTally& tally, const CurveOptions& options,
                                    Depth depth = Depth::kLive);

}  // namespace lab::analysis
