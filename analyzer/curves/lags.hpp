#pragma once

#include <vector>

#include "analyzer/laws.hpp"

namespace lab::analysis {

/// The lag grid of one program in whole frames, ascending: about `count` logarithmically spaced
/// lags from 1 frame to max_lag (s). For held noise it includes the frames nearest to epsilon and
/// 2 epsilon, where the angular MSD changes its form and the covariance-based estimators need lags.
/// At least one lag; frame_period in s must be positive.
[[nodiscard]] std::vector<int> makeLagGrid(double frame_period, double max_lag,
                                           const ProgramLaw& law, int count = 57);

/// The index of the lag nearest to `frames` in an ascending, non-empty grid.
[[nodiscard]] std::size_t nearestLag(const std::vector<int>& lags, double frames);

}  // namespace lab::analysis
