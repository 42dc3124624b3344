/// Estimators of the quantities of a program, as functions of sums over blocks.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "analyzer/curves/block_errors.hpp"
#include "analyzer/curves/msd_accumulator.hpp"
#include "analyzer/laws.hpp"

namespace lab::analysis {

/// Quantities that are measured directly from the sums of a program; nan if the program or the data
/// do not define them.
enum Quantity : std::size_t {
  kRotationalDiffusivity,     ///< D_r, rad^2/s.
  kSpeed,                     ///< Mean forward speed, in runs if there are runs, m/s.
  kPositionOffset,            ///< 4 sigma^2, contribution of tracker noise to the MSD, m^2.
  kHeadingOffset,             ///< 2 sigma_theta^2, rad^2.
  kAmplitude,                 ///< V, m/s.
  kTranslationalDiffusivity,  ///< D_t, m^2/s.
  kSlopeDiffusivity,          ///< D from the slope of the MSD, m^2/s.
  kTumbleRate,                ///< gamma, 1/s.
  kQuantities
};
using Quantities = std::array<double, kQuantities>;

/// The noise of the tracker; nan if the data do not determine it.
struct TrackerNoise {
  double position_offset = 0;  ///< 4 sigma^2, contribution to the MSD, m^2.
  double heading_offset = 0;   ///< 2 sigma_theta^2, rad^2.
};

/// The estimators of one program on one lag grid, as functions of the sums:
///
/// - D_r = epsilon <omega^2> / 2 with <omega^2> = [A(t2) - A(t1)] / [F(t2) - F(t1)], t1 and t2 the
///   lags nearest to epsilon and 2 epsilon and F the exact shape of the angular MSD A. The
///   difference removes the offset epsilon/3 of the law and the heading noise.
/// - v: mean displacement along the heading between consecutive frames over their time. Position
///   noise averages out; the chord of an arc and the heading noise are corrected. Runs and turns:
///   divided by the share of run time that the telemetry counted.
/// - 4 sigma^2: a robot does not move sideways, so displacement across the heading is noise.
/// - 2 sigma_theta^2: A at one frame, less the exact shape through A(one frame) and A(t1).
/// - V from MSD(t1) - MSD(one frame), D_t from MSD(t2) - MSD(t1), each over the exact law's
///   difference and less the part of the mean speed. Differences remove 4 sigma^2.
/// - D from the MSD's slope between five and ten persistence times, intercept free.
/// - gamma: tumbles over run time, the right-censored maximum-likelihood estimate.
class Estimator {
 public:
  Estimator(const ProgramLaw& law, const BlockData& data);

  [[nodiscard]] const ProgramLaw& law() const { return law_; }
  [[nodiscard]] const BlockSums& total() const { return total_; }  ///< Of the data.

  [[nodiscard]] Quantities operator()(const BlockSums& sums) const;
  [[nodiscard]] TrackerNoise noise(const BlockSums& sums) const;

  /// Indices of the lags that all this needs; and those that noise() needs. Each one once.
  [[nodiscard]] const std::vector<std::size_t>& neededLags() const { return needed_; }
  [[nodiscard]] const std::vector<std::size_t>& noiseLags() const { return noise_lags_; }

  /// The longest lag (s) that a quantity needs. Blocks must be several times longer.
  [[nodiscard]] double reach(Quantity quantity) const;

 private:
  [[nodiscard]] double msd(const BlockSums& sums, std::size_t i) const;
  [[nodiscard]] double angular(const BlockSums& sums, std::size_t i) const;
  [[nodiscard]] double turningScale(const BlockSums& sums, std::size_t from, std::size_t to) const;
  [[nodiscard]] double speed(const BlockSums& sums, const TrackerNoise& noise) const;
  [[nodiscard]] double chordOfUnknownTurning(const BlockSums& sums) const;

  ProgramLaw law_;
  BlockSums total_;
  std::vector<std::size_t> needed_;
  std::vector<std::size_t> noise_lags_;
  std::optional<HeldDraws> held_;
  std::optional<DrawnWheels> wheels_;
  std::optional<RunsAndTurns> runs_;
  double first_lag_ = 0;       ///< s.
  std::size_t third_lag_ = 0;  ///< Index of the lag of three frames; 0: none.
  std::size_t hold_ = 0;       ///< Index of the lag nearest to epsilon.
  std::size_t two_holds_ = 0;  ///< Index of the lag nearest to 2 epsilon.
  std::size_t slope_begin_ = 0;
  std::size_t slope_end_ = 0;
  double slope_time_ = 0;  ///< s, 0: no slope.
  std::vector<double> lag_times_;
  // By lag, filled at one frame and at the lags nearest to epsilon and 2 epsilon.
  std::vector<double> shape_;       ///< F: angular MSD of the law over <omega^2>.
  std::vector<double> mean_part_;   ///< MSD of unit mean wheel speed.
  std::vector<double> noise_part_;  ///< MSD of the programmed noise of the wheels.
};

}  // namespace lab::analysis
