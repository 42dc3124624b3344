/// The errors of pooled numbers from the scatter between robots, which differ in clocks, wheels and
/// surroundings.
#pragma once

#include <span>
#include <vector>

#include "analyzer/curves/estimates.hpp"

namespace lab::analysis {

/// The error of a weighted mean of independent robots.
struct RobotScatter {
  double sigma = 0;    ///< Standard error; nan: fewer than two robots.
  double freedom = 0;  ///< Degrees of freedom: the effective number of robots, less 1; at least 1.
};

/// From the scatter of the values about their weighted mean (random effects with given weights).
/// Unbiased both if the variance of a robot is inverse to its weight, as if all robots were equal,
/// and for equal weights. Values that are not finite are left out.
[[nodiscard]] RobotScatter scatterOfRobots(std::span<const double> values,
                                           std::span<const double> weights);

/// Widens the standard error and the 95 % interval of a pooled estimate to those of Student's t by
/// the scatter of its robots. They are not narrowed: with few robots a small scatter may be chance.
/// Positive quantities are treated by their logarithm, as their intervals.
/// @param scatter of the value, or of its logarithm if low95 is positive
void widenTo(Estimate& pool, const RobotScatter& scatter);

/// The same by the estimates of its robots.
/// @param robots one per robot, nullptr for robots without this estimate
/// @param weights of the robots, in the same order
void widenByRobots(Estimate& pool, std::span<const Estimate* const> robots,
                   std::span<const double> weights);

/// The same for every estimate of a pool, by the estimates of the same names.
void widenByRobots(std::vector<Estimate>& pool,
                   const std::vector<const std::vector<Estimate>*>& robots,
                   const std::vector<double>& weights);

}  // namespace lab::analysis
