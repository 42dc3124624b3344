/// The shape of the distribution from which turning rates are drawn.
#pragma once

#include <optional>

#include "analyzer/curves/estimates.hpp"

namespace lab::analysis {

/// Its kurtosis <omega^4> / <omega^2>^2.
struct DrawShape {
  double kurtosis = 0;
  double sigma = 0;       ///< Standard error, from blocks.
  double programmed = 0;  ///< 1.8: uniform; 2.4: the difference of two uniform wheel speeds.
  double z = 0;           ///< Deviation in standard errors, which include kShapeTolerance.
};

/// What motors that need time to change their speed, and the like, may change.
inline constexpr double kShapeTolerance = 0.02;

/// From the fourth and the second power of the rotation in half a hold. MSD and angular MSD depend
/// on the variance of the draws only, so they do not show their shape. Within one hold, a rotation
/// is the drawn rate times the lag; the part of the windows that sees a change is known.
/// @return nothing if there are no equal holds, fewer than four frames in one, frames that may keep
/// step with them, few draws, or a noise of the heading above the rotation
[[nodiscard]] std::optional<DrawShape> drawShape(const Estimator& estimator, const BlockData& data);

}  // namespace lab::analysis
