/// The error of the robots' clocks in intervals.
#pragma once

#include "analyzer/curves/estimates.hpp"

namespace lab::analysis {

/// Widens the interval of a number that a robot makes with its own clock, so that it holds the
/// programmed value as often as it says. Times and rates have the relative error kClockError of one
/// clock, whose average over `robots` is smaller.
/// @param power of the clock's period in the number: 1 for times, rates and diffusion coefficients
void widenByClocks(Estimate& estimate, double robots, double power = 1);

}  // namespace lab::analysis
