/// The mean turning rate: whether a robot circles.
#pragma once

#include <optional>

#include "analyzer/curves/block_sums.hpp"
#include "analyzer/laws.hpp"

namespace lab::analysis {

/// The mean turning rate of a program whose law turns left and right alike.
struct TurningRate {
  double value = 0;  ///< rad/s, positive to the left.
  double sigma = 0;  ///< Standard error by the law, rad/s.
  double z = 0;      ///< Deviation from the programmed 0 in standard errors.
};

/// The net rotation over its time. Its variance over a time T is that of the law's angular MSD at
/// long lags over T: 2 D_r / T. MSD and angular MSD hardly tell a slow circling from diffusion,
/// because they do not know the sign of a rotation.
/// @return nothing without headings, or without a law that draws turns to both sides
[[nodiscard]] std::optional<TurningRate> turningRate(const ProgramLaw& law, const BlockSums& total);

}  // namespace lab::analysis
