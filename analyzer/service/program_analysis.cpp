#include "analyzer/service/program_analysis.hpp"

#include "analyzer/curves/lags.hpp"

namespace lab::analysis {

ProgramAnalysis::ProgramAnalysis(const ProgramLaw& law, double frame_period, double max_lag)
    : law_(law), accumulator_(makeLagGrid(frame_period, max_lag, law), frame_period) {
  const double hold = law->steadyHold();
  if (HoldPeriodFinder::resolves(hold, frame_period)) holds_.emplace(hold, frame_period);
}

void setTally(ProgramResult& result, const ProgramTally& tally) {
  result.samples = tally.samples;
  result.lost = tally.lost;
  result.segments = tally.segments;
  result.reversals = tally.reversals;
  const std::int64_t frames = tally.samples + tally.in_contact;
  result.contact_share =
      frames > 0 ? static_cast<double>(tally.in_contact) / static_cast<double>(frames) : 0;
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
  result.verdict = judge(result.curves);
  result.no_verdict = law->whyNoVerdict();
  if (depth == Depth::kFull) result.kurtosis = testKurtosis(law, data);
  return result;
}

}  // namespace lab::analysis
