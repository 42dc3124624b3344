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
  double theory = 0;  ///< The programmed law's mean over the bar; nan: none.
};

/// Runs and tumbles of one robot, or of many together, from poses alone; SI units.
struct RunStatistics {
  std::string problem;        ///< Why there is nothing below; empty: there is.
  double observed = 0;        ///< s.
  std::int64_t tumbles = 0;   ///< Begun in view.
  std::int64_t runs = 0;      ///< Seen with their ends.
  std::int64_t cut_off = 0;   ///< Seen without, where the track ends.
  std::int64_t hidden = 0;    ///< Too short to be seen.
  double shortest = 0;        ///< The shortest run that counts as seen, s (the largest of robots).
  double tumble_scatter = 0;  ///< Standard deviation of the duration of single tumbles, s.
  double wheel_speed = 0;     ///< That 99 % of the turns stay below, m/s.
  double needed_wheel_speed = 0;  ///< For half a turn in the programmed tau_t, m/s.
  double beyond_half_turn = 0;  ///< Share of tumbles that turned by clearly more than 180 degrees.

  /// gamma, tau_r, tau_t, v, D, L_s, and the share of time in tumbles.
  std::vector<Estimate> estimates;
  std::vector<DensityBar> run_times;  ///< From `shortest` on.
  std::vector<DensityBar> turns;      ///< On [-pi, pi).
  TestResult exponential;             ///< Run times.
  TestResult uniform;                 ///< Turns, Kuiper.
  TestResult preferred;               ///< Turns, Rayleigh.
  TestResult independent;             ///< A run and the next one.

  [[nodiscard]] const Estimate* find(const std::string& name) const;
};

/// The statistics of an RTP of one robot or many.
///
/// gamma maximises the likelihood of all that was seen: whole runs of at least `shortest`
/// (exponential), runs that a track's end cut off (right-censored) or began with (the rest of an
/// exponential run is one), and the number of runs too short to be seen (interval-censored). With
/// n whole and h hidden runs its error is that of n + h counts; 95 % from Poisson's exact interval.
/// `gamma_truncated` leaves the hidden ones out (left-truncated): it needs no count of tumbles.
[[nodiscard]] RunStatistics runStatistics(const ProgramLaw& law,
                                          const std::vector<const FoundRuns*>& robots);

}  // namespace lab::analysis
