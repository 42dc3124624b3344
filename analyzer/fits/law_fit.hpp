#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analyzer/bootstrap/curve_covariance.hpp"
#include "analyzer/curves/estimates.hpp"
#include "analyzer/fits/fit_plan.hpp"
#include "analyzer/fits/law_hypothesis.hpp"

namespace lab::analysis {

/// The iterated generalised least squares fit of the exact law to MSD and angular MSD together.
///
/// Free parameters are the logarithms of the speed and of the noise (Law::fitParameters), and the
/// tracker offsets 4 sigma^2 and 2 sigma_theta^2. Fixed at the programmed values are the wheel base
/// and, unless FitOptions::free_times names them, epsilon and tau_t. About
/// ten lags are used, from max(one frame, epsilon/5) to 8 epsilon (runs and turns: by the shorter
/// and the longer one of their times). The covariance is that of recordings simulated at the fitted
/// parameters: of the ordinary least-squares fit, then of the first generalised one. The systematic
/// floor is added to the diagonal of the MSD.
///
/// Intervals are those of Student's t for the logarithm. Errors are cross-validated: the scatter of
/// recordings under weights from the other recordings. So they include the error of a covariance
/// that is known from a finite number of skew recordings only.
struct LawFit {
  std::string refusal;               ///< Reason if there is no fit; empty: fitted.
  std::vector<Estimate> parameters;  ///< The free ones, then the tracker offsets.
  std::vector<Estimate> derived;     ///< D_r, D_t, D, L_s of the fitted law.
  std::vector<double> correlation;   ///< Of the parameters, row by row.
  ProgramLaw law;                    ///< The program with the fitted parameters.
  std::vector<double> lags;          ///< s.
  bool angular = false;              ///< The angular MSD was used.
  double chi2 = 0;     ///< Squared distance, with the robots' clocks free in their error.
  int freedom = 0;     ///< Number of lags of all curves less that of parameters.
  double p_value = 0;  ///< Of chi2, by DistanceDistribution.
  int recordings = 0;  ///< Simulated recordings of the covariance.
  double recording_duration = 0;  ///< s.
  /// Largest difference of a parameter from its ordinary least-squares value, in standard errors of
  /// this difference if law and covariance are correct. Above 4 the fit is not reliable.
  double guard_z = 0;
  bool regularised =
      false;  ///< The covariance was numerically singular; its diagonal was increased.
  std::optional<LawTest> exact;      ///< Test of the exact law as programmed, both curves.
  std::optional<LawTest> exact_msd;  ///< The same, the MSD alone.
  std::optional<LawTest> paper;      ///< Test of the paper's formula for the MSD.

  [[nodiscard]] bool fitted() const { return refusal.empty(); }
};

/// Fits the law. With `given` (recordings of the same program on the same lag grid) nothing is
/// simulated. Simulated recordings are stored in `used`, unless it is nullptr.
[[nodiscard]] LawFit fitLaw(const ProgramLaw& law, const MeasuredCurves& curves,
                            const FitOptions& options, const SimulatedCurves* given = nullptr,
                            SimulatedCurves* used = nullptr);

}  // namespace lab::analysis
