#pragma once

#include <cmath>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "analyzer/fits/law_fit.hpp"
#include "tests/analyzer/recording_ensemble.hpp"

namespace lab::analysis {

/// Results of the fits of many recordings of one program, relative to the truth.
struct FitScatter {
  struct Number {
    Scatter relative;  ///< value / truth - 1
    Scatter sigma;     ///< stated, relative to the truth
    int covered = 0;
  };
  std::map<std::string, Number> numbers;
  Scatter chi2;
  std::vector<double> fit_p;    ///< of chi2
  std::vector<double> exact_p;  ///< of the test of the exact law
  int recordings = 0;
  int refused = 0;
  int unlikely = 0;        ///< chi2 below p = 0.01
  int guarded = 0;         ///< guard_z above 4
  int exact_rejected = 0;  ///< at p < 0.01
  int paper_rejected = 0;

  void add(const LawFit& fit) {
    ++recordings;
    if (!fit.fitted()) {
      ++refused;
      return;
    }
    for (const auto* list : {&fit.parameters, &fit.derived}) {
      for (const Estimate& e : *list) {
        if (!std::isfinite(e.theory)) continue;
        Number& number = numbers[e.name];
        number.relative.add(e.value / e.theory - 1);
        number.sigma.add(e.sigma / e.theory);
        number.covered += e.low95 <= e.theory && e.theory <= e.high95 ? 1 : 0;
      }
    }
    chi2.add(fit.chi2);
    fit_p.push_back(fit.p_value);
    if (fit.exact) exact_p.push_back(fit.exact->p_value);
    unlikely += fit.p_value < 0.01 ? 1 : 0;
    guarded += fit.guard_z > 4 ? 1 : 0;
    exact_rejected += fit.exact && fit.exact->p_value < 0.01 ? 1 : 0;
    paper_rejected += fit.paper && fit.paper->p_value < 0.01 ? 1 : 0;
  }

  [[nodiscard]] double share(const std::string& name) const {
    return static_cast<double>(numbers.at(name).covered) / recordings;
  }
  [[nodiscard]] double sd(const std::string& name) const {
    return numbers.at(name).relative.deviation();
  }
};

/// The curves of one recording, computed by the analyzer from poses.
inline MeasuredCurves curvesOfRecording(const WalkerRecording& recording, double max_lag) {
  ProgramAnalysis analysis(recording.law, 1 / recording.fps, max_lag);
  for (const Sample& sample : stitch(recording).samples) analysis.add(sample);
  return measuredCurves(recording.law, analysis.data());
}

/// Fits `recordings` recordings. Unless nested, the recordings of the covariance are simulated
/// at the true parameters, and reused for `reused` recordings. The clocks of the robots have
/// relative errors with the standard deviation `clock_error`.
inline FitScatter fitRecordings(const WalkerRecording& programmed, int recordings, double max_lag,
                                bool nested, bool tests, double clock_error = 0,
                                int reused = 1 << 30) {
  FitScatter result;
  SimulatedCurves truth;
  SimulatedCurves octaves;
  FitOptions options;
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  WalkerRecording recording = programmed;
  for (int i = 0; i < recordings; ++i) {
    recording.seed = 90000U + static_cast<unsigned>(i);
    WalkerRecording filmed = recording;
    if (clock_error > 0) filmed.law = recording.law.slowed(1 + clock_error * normal(random));
    ProgramAnalysis analysis(recording.law, 1 / recording.fps, max_lag);
    for (const Sample& sample : stitch(filmed).samples) analysis.add(sample);
    const MeasuredCurves curves = measuredCurves(recording.law, analysis.data());
    if (i % reused == 0) {
      options.seed = 1 + 1000 * static_cast<unsigned>(i);
      MeasuredCurves known = curves;
      known.offset = 4 * recording.sigma * recording.sigma;
      known.angular_offset = 2 * recording.sigma_theta * recording.sigma_theta;
      truth = simulateForFit(recording.law, known.offset, known.angular_offset, known,
                             planFit(recording.law, known, options), options);
      if (tests) octaves = simulateForTest(recording.law, known, 400, options.seed + 4);
    }
    LawFit fit = fitLaw(recording.law, curves, options, nested ? nullptr : &truth);
    if (tests) {
      fit.exact = testLaw(TestedLaw::kExact, recording.law, curves, octaves, {});
      fit.paper = testLaw(TestedLaw::kPaper, recording.law, curves, octaves, {});
    }
    result.add(fit);
  }
  return result;
}

/// No hold time is a multiple of the frame period, so the phase sweeps.
inline WalkerRecording fitRecording(const ProgramLaw& law, double duration) {
  WalkerRecording recording;
  recording.law = law;
  recording.duration = duration;
  recording.fps = 9.97;
  recording.telemetry_rate = 2;
  recording.sigma = 0.0005;
  recording.sigma_theta = 0.025;
  return recording;
}

}  // namespace lab::analysis
