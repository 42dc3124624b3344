#include "analyzer/service/program_analysis.hpp"

#include "analyzer/curves/lags.hpp"

namespace lab::analysis {

ProgramAnalysis::ProgramAnalysis(const ProgramLaw& law, double frame_period, double max_lag)
    : law_(law),
      accumulator_(makeLagGrid(frame_period, max_lag, law), frame_period, law->runs().has_value()) {
  const double hold = law->steadyHold();
  if (HoldPeriodFinder::resolves(hold, frame_period)) holds_.emplace(hold, frame_period);
}

void ProgramAnalysis::collectWhole(double frame_period, double max_lag) {
  whole_.emplace(makeLagGrid(frame_period, max_lag, law_), frame_period);
}

void judgeMotion(ProgramResult& result) {
  result.verdict = judge(result.curves);
  if (result.fit && result.fit->fitted() && result.verdict.kind != VerdictKind::kUndecided) {
    result.verdict.misfit = result.fit->p_value < kUnlikely;
    result.verdict.rejected = result.fit->exact && result.fit->exact->p_value < kUnlikely;
    if (result.verdict.misfit || result.verdict.rejected) {
      result.verdict.kind = VerdictKind::kDisagrees;
    }
  }
  if (result.shares.contact > kMostlyContact) result.verdict.kind = VerdictKind::kUndecided;
}

void setTally(ProgramResult& result, const ProgramTally& tally) {
  result.samples = tally.samples;
  result.lost = tally.lost;
  result.segments = tally.segments;
  result.reversals = tally.reversals;
  const std::int64_t frames = tally.samples + tally.in_contact;
  result.contact_share =
      frames > 0 ? static_cast<double>(tally.in_contact) / static_cast<double>(frames) : 0;
  result.shares = sharesOf(tally);
}

ProgramResult analyse(const ProgramLaw& law, const BlockData& data, const ProgramTally& tally,
                      const CurveOptions& options, Depth depth) {
  ProgramResult result;
  result.law = law;
  result.robots = static_cast<int>(data.tracks.size());
  result.observed = data.observed();
  setTally(result, tally);
  result.unbiased_lag = options.unbiased_lag;
  if (result.observed > 0) {
    const Estimator estimator(law, data);
    result.curves = curves(estimator, data, options);
    result.estimates = estimate(estimator, data);
  }
  judgeMotion(result);
  result.no_verdict = law->whyNoVerdict();
  if (depth == Depth::kFull) result.kurtosis = testKurtosis(law, data);
  return result;
}

}  // namespace lab::analysis
