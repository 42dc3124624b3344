#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "analyzer/curves/estimates.hpp"
#include "analyzer/runs/run_finder.hpp"
#include "analyzer/runs/run_hypothesis.hpp"

namespace lab::analysis {

/// One bar of a measured probability density.
struct DensityBar {
  double low = 0;  ///< s or rad.
  double high = 0;
  double density = 0;  ///< Per s or rad.
  double sigma = 0;
  double count = 0;
  double theory = 0;  ///< Mean of the programmed law over the bar; nan: none.
};

/// Runs and tumbles of one robot, or of many together, from poses alone; SI units.
struct RunStatistics {
  std::string problem;        ///< Reason if there are no results; empty: there are.
  double observed = 0;        ///< s.
  std::int64_t tumbles = 0;   ///< Tumbles whose beginning was observed.
  std::int64_t runs = 0;      ///< Runs whose end was observed.
  std::int64_t cut_off = 0;   ///< Runs that the end of a track cut off.
  std::int64_t hidden = 0;    ///< Runs too short to be detected.
  double shortest = 0;        ///< Duration of the shortest detectable run, s (maximum over robots).
  double tumble_scatter = 0;  ///< Standard deviation of the duration of single tumbles, s.
  double wheel_speed = 0;     ///< Wheel speed that 99 % of the turns stay below, m/s.
  double needed_wheel_speed = 0;  ///< Wheel speed for half a turn in the programmed tau_t, m/s.
  double beyond_half_turn = 0;    ///< Share of tumbles that turned by more than 198 degrees.

  /// gamma, tau_r, tau_t, v, omega (of runs), D, L_s, and the share of time in tumbles.
  std::vector<Estimate> estimates;
  std::vector<DensityBar> run_times;  ///< Distribution of run times, from `shortest` on.
  std::vector<DensityBar> turns;      ///< On [-pi, pi).
  TestResult exponential;             ///< Run times.
  TestResult uniform;                 ///< Turns: Kuiper.
  TestResult preferred;               ///< Turns: Rayleigh.
  TestResult independent;             ///< Successive runs: correlation.

  [[nodiscard]] const Estimate* find(const std::string& name) const;
};

/// The statistics of runs and turns of one robot or many.
///
/// gamma maximises the likelihood of all observations: whole runs of at least `shortest`
/// (exponential), runs that the end of a track cut off (right-censored) or that a track began with
/// (the rest of an exponential run is exponential), and the number of runs too short to be detected
/// (interval-censored). With n whole and h hidden runs its error is that of n + h counts; the 95 %
/// interval is Poisson's. `gamma_truncated` omits the hidden ones (left-truncated) and does not
/// need the count of tumbles.
[[nodiscard]] RunStatistics runStatistics(const ProgramLaw& law,
                                          const std::vector<const FoundRuns*>& robots);

}  // namespace lab::analysis
