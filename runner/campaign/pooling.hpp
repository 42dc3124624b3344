/// Pools the runs of each point of a campaign. Pure functions.
#pragma once

#include <vector>

namespace lab::runner::campaign {

/// One number of one run.
struct RunNumber {
  double value = 0;
  double sigma = 0;              ///< its standard error; nan: none is known
  double low95 = 0;              ///< its own interval; nan: none
  double high95 = 0;             ///< nan: none
  double effective_samples = 0;  ///< independent samples in sigma; nan or 0: not known
};

/// The runs of one point together.
struct PooledNumber {
  int runs = 0;
  double mean = 0;                ///< nan without a run
  double sigma = 0;               ///< standard error of the mean; nan: not known
  double low95 = 0;               ///< 95 % interval of the mean; nan: not known
  double high95 = 0;              ///< see low95
  double degrees_of_freedom = 0;  ///< of the interval; infinite: normal
  /// Standard deviation between the true values of runs beyond their own errors; nan: not known.
  double between = 0;
};

/// Pools every point by random effects: runs of a point are draws from one distribution, whose
/// variance is that between runs plus that of their own errors. As they have the same design, the
/// mean has equal weights. (Weights by the inverse squared errors would favour low values, because
/// the errors of most estimates grow with the estimate.)
///
/// A few runs determine their variance badly. It is therefore measured in units of the mean squared
/// error of the runs, and this ratio is moderated over the points: empirical Bayes of variances
/// (Smyth 2004, Stat. Appl. Genet. Mol. Biol. 3, 3), with an F distribution fitted to the ratios of
/// at least five points. The interval is Student's t with the degrees of freedom of the point
/// and of the prior, at most those of all points. The errors of the errors are included by their
/// effective samples.
///
/// A point of one run has the error of the prior, or the run's own interval if all points have one
/// run.
/// @param points the runs of each point; numbers that are not finite are left out
[[nodiscard]] std::vector<PooledNumber> pool(const std::vector<std::vector<RunNumber>>& points);

}  // namespace lab::runner::campaign
