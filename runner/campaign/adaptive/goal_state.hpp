/// What is known of the goal of an adaptive campaign, and what further runs would tell. Pure
/// functions.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "common/experiment/sweep.hpp"
#include "runner/campaign/adaptive/expected_reduction.hpp"
#include "runner/campaign/power_law.hpp"

namespace lab::runner::campaign {

/// A point at which a run may be made.
struct Candidate {
  std::vector<double> keys;  ///< the swept keys but for the length of the run
  double duration = 0;       ///< [s] of a run
};

/// What a run gave.
struct RunValue {
  std::size_t candidate = 0;
  double value = 0;
  double sigma = 0;              ///< its standard error
  double effective_samples = 0;  ///< independent samples in sigma; nan or 0: not known
};

/// What all runs of one candidate gave.
struct MeasuredPoint {
  std::size_t candidate = 0;
  double mean = 0;
  double variance = 0;  ///< of the mean
};

/// A key scaled to the range of the candidates: from 0 to 1. By logarithms if all values are
/// positive and the largest is at least five times the smallest.
struct KeyScale {
  double low = 0;
  double high = 1;
  bool logarithmic = false;

  [[nodiscard]] double scaled(double value) const;
  [[nodiscard]] double value(double scaled) const;  ///< the inverse of scaled()
};

/// The campaign so far, as numbers for the models.
struct Measurements {
  std::vector<KeyScale> scales;       ///< of each key
  Eigen::MatrixXd inputs;             ///< candidates x keys, from 0 to 1
  Eigen::VectorXd noise;              ///< variance of one run at each candidate
  std::vector<MeasuredPoint> points;  ///< that have a run
};

/// Errors as shares of the values (of the mean over all runs of a point), or absolute ones.
enum class ErrorScale : bool { kAbsolute, kRelative };

/// The variance of a run is that of the noise
/// model, fitted to the stated errors, times the scatter of runs about their point's mean in units
/// of it, if that exceeds one. With kRelative, variances are those of the logarithm.
[[nodiscard]] Measurements measurementsOf(const std::vector<Candidate>& candidates,
                                          const std::vector<RunValue>& runs, ErrorScale scale);

/// The candidates' distinct keys: the index of the first candidate of each.
[[nodiscard]] std::vector<std::size_t> distinctPlaces(const std::vector<Candidate>& candidates);

/// What is known of one place.
struct SurfacePoint {
  std::size_t candidate = 0;  ///< the first one of the place
  double value = 0;
  double sigma = 0;  ///< its standard error
};

/// Where the quantity crosses the level on a line along the first key.
struct Crossing {
  std::size_t candidate = 0;  ///< the first one that has the other keys of the line
  double position = 0;        ///< of the first key
  double sigma = 0;           ///< its standard error
};

struct GoalState {
  GaussianDesign design;
  /// The root of design.variance(): the standard error of what is asked. Infinite while there are
  /// fewer measured points than parameters and one more.
  double error = std::numeric_limits<double>::infinity();
  std::vector<SurfacePoint> surface;  ///< of all places; empty before the first run
  std::optional<PowerLaw> law;        ///< of kLaw, when it can be fitted
  std::vector<Crossing> crossings;    ///< of kBoundary: of the lines that cross the level
};

/// A mean: a Gaussian process. The variance that is asked for is the mean over all places.
[[nodiscard]] GoalState surfaceState(const AdaptivePlan& plan,
                                     const std::vector<Candidate>& candidates,
                                     const std::vector<RunValue>& runs);

/// A boundary: the same process on lines along the first key, one for each combination of the other
/// keys. The variance that is asked for is that of the crossings' positions, as shares of the range
/// of the key: the variance of the process over its squared slope, where the process is at the
/// level, averaged over the probability density of that (Picheny et al. 2010, J. Mech. Des. 132,
/// 071008) and over the lines. While no line crosses the level, it is that of all places.
[[nodiscard]] GoalState boundaryState(double level, const std::vector<Candidate>& candidates,
                                      const std::vector<RunValue>& runs);

/// What of a power law is asked.
enum class LawParameter : std::int8_t {
  kExponents,    ///< the mean of their variances
  kOneExponent,  ///< that of one key
  kPrefactor,    ///< relative error
  kCurve,        ///< relative errors at all places
};

/// A power law: quasi-likelihood (power_law.hpp) with smoothed errors (noise_model.hpp). The design
/// is the linear model of the logarithms with weak normal priors. Its errors are widened by the
/// residuals of the law, if they exceed the errors of the points.
/// @param key number of the key of kOneExponent
/// @param candidates with positive keys
[[nodiscard]] GoalState lawState(LawParameter parameter, std::size_t key,
                                 const std::vector<Candidate>& candidates,
                                 const std::vector<RunValue>& runs);

}  // namespace lab::runner::campaign
