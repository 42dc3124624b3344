#pragma once

#include <vector>

#include "analyzer/bootstrap/curve_covariance.hpp"
#include "analyzer/curves/estimates.hpp"
#include "analyzer/curves/msd_accumulator.hpp"
#include "analyzer/laws.hpp"
#include "common/math/units.hpp"

namespace lab::analysis {

/// One lag of a measured curve, SI units. A lag without windows has nan, never 0.
struct CurvePoint {
  double tau = 0;    ///< s.
  double value = 0;  ///< As measured, tracker noise included.
  double noise = 0;  ///< What tracker noise adds to it.
  double sigma = 0;  ///< Standard error of value.
  double windows = 0;
  double n_eff = 0;               ///< Independent windows that would give the same sigma.
  double exact = 0;               ///< The exact law of the programmed parameters, without noise.
  double paper = 0;               ///< The paper's formula.
  double z = 0;                   ///< Deviation from the law in standard errors, see curves().
  double kurtosis = 0;            ///< <r^4> / <r^2>^2: 2 for isotropic Brownian motion, 3 in 1D.
  bool selection_biased = false;  ///< The windows were selected by the outcome: no verdict.
  bool judged = false;            ///< Goes into the verdict.
};

struct Curves {
  std::vector<CurvePoint> msd;
  std::vector<CurvePoint> angular_msd;
};

struct CurveOptions {
  double systematic_floor = 0.002;  ///< Share of the law below which no deviation counts.
  double speed_tolerance = 0.05;    ///< Share by which the speed may be off as a calibration.
  double unbiased_lag = 0;          ///< Longer lags are selected by the outcome, s; 0: none is.
  /// Recordings of the program, or none. With them the errors of lags beyond a 180th of a track,
  /// where blocks are too short (they give up to 36 % too little), are those of the recordings.
  const SimulatedCurves* recordings = nullptr;
  /// m^2: 4 sigma^2 of the tracker as a fit of the law has it, and its error. Taken out where the
  /// recording has no headings that would tell it; nan: not known, and then nothing is judged.
  double offset = units::kNan;
  double offset_sigma = 0;
};

/// The relative standard error of the MSD over one recording of length `observed` (s) that the law
/// itself predicts: sqrt(2 tau / 3T) in 2D, sqrt(4 tau / 3T) for motion along one axis, plus the
/// scatter of the draws at short lags. Needed where blocks are too short or too few to tell.
[[nodiscard]] double modelMsdError(const ExactLaw& law, double tau, double observed);
[[nodiscard]] double modelAngularError(const ExactLaw& law, double tau, double observed);

/// MSD and angular MSD with errors from blocks at least five lags long; where there are fewer than
/// twelve of these, the larger of the blocks' and the law's own error. z compares with the exact
/// law at the measured speed if that is within speed_tolerance of the programmed one, with the
/// tracker's noise removed and the systematic floor added to the error. Where the law predicts its
/// own error (everywhere but in the ABP's MSD) the error behind z is never below it, since blocks
/// of a recording that fluctuates low also scatter little; a deviation in terms of few blocks is
/// turned into the normal deviate that is as improbable.
[[nodiscard]] Curves curves(const ProgramLaw& law, const BlockData& data,
                            const CurveOptions& options);

enum class VerdictKind { kUndecided = 0, kAgrees = 1, kDisagrees = 2 };

/// Whether the motion is the programmed one.
struct Verdict {
  VerdictKind kind = VerdictKind::kUndecided;
  double max_z = 0;      ///< Largest |z| over the judged lags of both curves.
  double tau = 0;        ///< Where, s.
  bool angular = false;  ///< In which curve.
  int judged = 0;        ///< Lags.
};

/// The lags are strongly correlated, so that the sum of z^2 means nothing; the largest |z| does. It
/// exceeds 3.2 in 1 % of recordings of the true law: agreement means below 4. Undecided with fewer
/// than five judged lags.
[[nodiscard]] Verdict judge(const Curves& curves);

}  // namespace lab::analysis
