/// Parameters of the simulation of a run, from twins of which they are known. Pure functions.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "runner/campaign/twins/twin_comparison.hpp"

namespace lab::runner::campaign {

/// The parameters of a run.
struct TwinEstimates {
  std::vector<double> values;
  std::vector<double> sigmas;                    ///< standard errors
  std::vector<std::vector<double>> correlation;  ///< of the errors
  /// Share of the parameter's variance over the twins that the looks predict, for twins that did
  /// not serve for the prediction. Near 0: the run does not know the parameter.
  std::vector<double> known;
  double freedom = 0;  ///< degrees of freedom of the errors
};

/// Each parameter is predicted by a linear function of the looks, found by ridge regression over
/// the twins; the penalty is the one with the smallest error of twins that are left out in turn.
/// The predictions are few numbers that know most of what the looks tell about the parameters
/// (Fearnhead and Prangle, J. R. Stat. Soc. B 74, 419 (2012)). Over the twins they are polynomials
/// of second degree in the parameters, with a scatter: the parameters of the run are those at which
/// its predictions are expected, and the scatter gives their errors. Twins that were left out are
/// used for both, so that the errors contain those of the regression.
///
/// @param looks of the run and its twins; those that the run or a twentieth of the twins lack, or
/// that do not vary, are left out
/// @param drawn of each twin, the same number of parameters
/// @throws std::invalid_argument with fewer than n^2 + 4 n + 10 twins for n parameters, or no look
[[nodiscard]] TwinEstimates estimateParameters(const std::vector<Look>& looks,
                                               const std::vector<std::vector<double>>& drawn);

/// The mean of the estimates of several runs, weighted by their inverse covariances.
struct PooledEstimates {
  TwinEstimates estimates;
  double p = 1;  ///< probability of as large differences between the runs by chance
};
[[nodiscard]] PooledEstimates poolEstimates(const std::vector<TwinEstimates>& runs);

}  // namespace lab::runner::campaign
