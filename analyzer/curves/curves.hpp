#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analyzer/bootstrap/curve_covariance.hpp"
#include "analyzer/curves/draw_shape.hpp"
#include "analyzer/curves/estimates.hpp"
#include "analyzer/curves/hold_period.hpp"
#include "analyzer/curves/msd_accumulator.hpp"
#include "analyzer/curves/turning_rate.hpp"
#include "analyzer/laws.hpp"
#include "common/math/units.hpp"

namespace lab::analysis {

/// One lag of a measured curve, SI units. A lag without windows has nan, never 0.
struct CurvePoint {
  double tau = 0;    ///< s.
  double value = 0;  ///< As measured, including tracker noise.
  double noise = 0;  ///< Contribution of tracker noise to value.
  double sigma = 0;  ///< Standard error of value.
  double windows = 0;
  double n_eff = 0;               ///< Number of independent windows with the same sigma.
  double exact = 0;               ///< The exact law of the programmed parameters, without noise.
  double paper = 0;               ///< The paper's formula.
  double z = 0;                   ///< Deviation from the law in standard errors, see curves().
  double kurtosis = 0;            ///< <r^4> / <r^2>^2: 2 for isotropic Brownian motion, 3 in 1D.
  bool selection_biased = false;  ///< The windows are a biased sample (unbiased_lag); not judged.
  bool judged = false;            ///< Counts for the verdict.
};

struct Curves {
  std::vector<CurvePoint> msd;
  std::vector<CurvePoint> angular_msd;
  std::optional<HoldPeriod> hold;  ///< Of programs that draw a turning rate at equal intervals.
  std::optional<TurningRate> turning;
  std::optional<DrawShape> draws;
  /// Frames after which they lie at the same phases of the hold again (FramePhases); 0: they do
  /// not.
  int frames_in_step = 0;
};

struct CurveOptions {
  double systematic_floor =
      0.002;  ///< Relative deviation from the law that is allowed as systematic.
  double speed_tolerance =
      0.04;  ///< Relative error of the speed that is accepted as a calibration error.
  /// Windows of longer lags are a biased sample, because the motion decides whether they exist
  /// (Analysis::setSpatialLight), s; 0: no lag is biased.
  double unbiased_lag = 0;
  /// Simulated recordings of the program, or nullptr. They give the errors of lags beyond a 180th
  /// of a track, for which blocks are too short and give errors up to 36 % too small.
  const SimulatedCurves* recordings = nullptr;
  /// 4 sigma^2 of the tracker (m^2) and its error, from a fit of the law. Used if the recording has
  /// no headings, which else determine it; nan: unknown, and then nothing is judged.
  double offset = units::kNan;
  double offset_sigma = 0;
  std::vector<std::string> free_times;  ///< As FitOptions::free_times.
};

/// MSD and angular MSD with errors from blocks that are at least five lags long. If there are fewer
/// than twelve blocks, the error is the larger one of the block error and the prediction of the
/// law. z compares with the exact law, at the measured speed if that is within speed_tolerance of
/// the programmed one, with the tracker noise removed and the systematic floor added to the error.
/// The error in z is not below the prediction of the law (if it has one:
/// Law::predictsMsdError), because blocks of a recording that fluctuates low also scatter little.
/// With few blocks, z is converted to the normal deviate of equal probability.
[[nodiscard]] Curves curves(const ProgramLaw& law, const BlockData& data,
                            const CurveOptions& options);

/// The same with the estimators of these data, of which there must be some.
[[nodiscard]] Curves curves(const Estimator& estimator, const BlockData& data,
                            const CurveOptions& options);

enum class VerdictKind { kUndecided = 0, kAgrees = 1, kDisagrees = 2 };

/// Whether the measured motion is the programmed one.
struct Verdict {
  VerdictKind kind = VerdictKind::kUndecided;
  double max_z = 0;      ///< Largest |z| over the judged lags of both curves.
  double tau = 0;        ///< The lag of max_z, s.
  bool angular = false;  ///< max_z is in the angular MSD.
  bool hold = false;     ///< max_z is that of the hold time, and tau the measured hold time.
  bool turning = false;  ///< max_z is that of the mean turning rate, and there is no tau.
  bool draws = false;    ///< max_z is that of the shape of the draws, and there is no tau.
  int judged = 0;        ///< Number of judged lags.
  /// By ProgramResult::fit, if there is one: whether no parameters describe the curves, and whether
  /// the programmed ones do not. Either makes it kDisagrees.
  bool misfit = false;
  bool rejected = false;
};

/// Judges by the largest |z|, because the lags are strongly correlated and the sum of z^2 has no
/// known distribution. The measured hold time, the mean turning rate and the kurtosis of the draws
/// count as one more lag each: the curves hardly depend on them if the diffusivities are right. The
/// largest |z| exceeds 3.2 in 1 % of recordings of the true law; below 4 the motion agrees.
/// Undecided with fewer than five judged lags.
[[nodiscard]] Verdict judge(const Curves& curves);

}  // namespace lab::analysis
