/// The points of a campaign: a grid, tuples, or a random design. Pure functions.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/experiment/sweep.hpp"
#include "runner/campaign/axis.hpp"

namespace lab::runner::campaign {

/// The experiment of each point is checked, written and kept: about 1 ms and 7 kB.
inline constexpr std::int64_t kMostPoints = 100'000;

/// What decides the points.
struct Design {
  std::vector<Axis> axes;
  bool zip = false;         ///< the n-th point has the n-th value of every axis
  std::int64_t random = 0;  ///< number of points that are drawn; 0: all combinations
  Sampling sampling = Sampling::kLatin;
  std::uint64_t seed = 1;  ///< of the draws
};

/// One value for each axis, in the order of the axes.
using PointValues = std::vector<std::string>;

/// The points, each different. Without axes there is one. Combinations: the last axis varies
/// fastest.
///
/// A random design draws each axis from its range, or from its values with equal probability. A
/// Latin hypercube (McKay, Beckman, Conover 1979) has one point in each of `random` equal parts of
/// every axis. Sobol's sequence (Joe and Kuo's directions, shifted by random digits) also fills the
/// planes of two axes evenly.
/// @throws UserError if the axes do not fit together, or there are too many points
[[nodiscard]] std::vector<PointValues> pointsOf(const Design& design);

}  // namespace lab::runner::campaign
