/// What residuals that go together mean for the centre. Internal to the circle fit.
#pragma once

#include <algorithm>
#include <cmath>

#include "tracker_svc/circle_fit/circle_fit_pixels.hpp"

namespace lab::detector::fit {

/// Correlation of neighbouring residuals beyond which it is no chance: three standard errors.
[[nodiscard]] inline float correlationByChance(int pixels) {
  return 3 / std::sqrt(static_cast<float>(std::max(1, pixels)));
}

/// Correlation of neighbouring residuals, of what is opposite on opposite sides of the centre, over
/// the square of all residuals. Blur that is no Gaussian is the same on both sides, and moves
/// nothing; a light edge is not. "Opposite" is seen from the grid point, a quarter of a pixel from
/// the centre at most. 1 where that cannot be told: of large circles not every row is looked at.
[[nodiscard]] double antisymmetricCorrelation(const Window& window);

/// By how much the centre's variance differs from what it would be if the window's residuals, which
/// go together, were noise.
///
/// What is the same on opposite sides of the centre (another blur, another shape, light that bends)
/// moves nothing: only what is opposite counts, which is half of the squares of noise. What
/// neighbours share of that makes fewer independent numbers of many pixels: along rows and columns
/// alike, with a correlation that falls geometrically, by (1 + rho) / (1 - rho) each.
[[nodiscard]] double varianceInflation(const Window& window, int pixels);

}  // namespace lab::detector::fit
