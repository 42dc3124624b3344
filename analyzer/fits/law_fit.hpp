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
/// Free are the logarithms of the speed (v, or va; not the BP's) and of the noise (eta, V, gamma
/// and perhaps tau_t), and the tracker's offsets 4 sigma^2 and 2 sigma_theta^2. Given are epsilon,
/// wheel base and, usually, tau_t, as programmed: an error of the robot's clock is not in the
/// intervals. Lags: some ten from max(a frame, epsilon/5) to 8
/// epsilon (RTP: of the shorter and the longer of 1/gamma and tau_t). The covariance is that of
/// recordings simulated at the fitted point: once at the least-squares fit, once more at the first
/// generalised one; the systematic floor is added to the MSD's diagonal.
///
/// Intervals are Student's t in the logarithm. The errors are cross-validated: the scatter of
/// recordings under weights made from the other recordings, so that they hold what a covariance
/// known from a finite number of skewed recordings costs.
struct LawFit {
  std::string refusal;               ///< Why there is no fit; empty: there is one.
  std::vector<Estimate> parameters;  ///< Free ones, then tracker offsets.
  std::vector<Estimate> derived;     ///< D_r, D_t, D, L_s of the fitted law.
  std::vector<double> correlation;   ///< Of the parameters, row by row.
  ProgramLaw law;                    ///< With the fitted parameters.
  std::vector<double> lags;          ///< s.
  bool angular = false;              ///< Whether headings went in.
  double chi2 = 0;
  int freedom = 0;                ///< Degrees of freedom of chi2.
  double p_value = 0;             ///< Of chi2, by Hotelling's distribution.
  int recordings = 0;             ///< Behind the covariance.
  double recording_duration = 0;  ///< s.
  /// Largest deviation of a parameter from the ordinary least squares' one, in the standard errors
  /// that this difference has if law and covariance are right. Above 4 do not trust the fit.
  double guard_z = 0;
  bool regularised = false;  ///< The covariance was singular to rounding; its diagonal was raised.
  std::optional<LawTest> exact;      ///< Test of the exact law as programmed, both curves.
  std::optional<LawTest> exact_msd;  ///< The same, the MSD alone.
  std::optional<LawTest> paper;      ///< Test of the paper's formula for the MSD.

  [[nodiscard]] bool fitted() const { return refusal.empty(); }
};

/// Fits. With `given` (recordings of the same program on the same lag grid) nothing is simulated;
/// recordings that were simulated are left in `used`, if asked for.
[[nodiscard]] LawFit fitLaw(const ProgramLaw& law, const MeasuredCurves& curves,
                            const FitOptions& options, const SimulatedCurves* given = nullptr,
                            SimulatedCurves* used = nullptr);

}  // namespace lab::analysis
