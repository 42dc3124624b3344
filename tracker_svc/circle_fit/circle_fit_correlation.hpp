/// Effect of correlated residuals on the centre. Internal to the circle fit.
#pragma once

#include <algorithm>
#include <cmath>

#include "tracker_svc/circle_fit/circle_fit_pixels.hpp"

namespace lab::detector::fit {

/// Correlation of neighbouring residuals above which it is significant: three standard errors.
[[nodiscard]] inline float correlationByChance(int pixels) {
  return 3 / std::sqrt(static_cast<float>(std::max(1, pixels)));
}

/// Correlation of neighbouring residuals, of the part that is antisymmetric about the centre, over
/// the square of all residuals. A blur that is not Gaussian is symmetric and does not displace the
/// centre; a light edge is not symmetric. The centre of symmetry is the grid point, at most a
/// quarter of a pixel from the centre. Returns 1 if it cannot be computed: for large circles not
/// every row is sampled.
[[nodiscard]] double antisymmetricCorrelation(const Window& window);

/// Factor on the centre's variance because the residuals in the window are correlated and not
/// independent noise.
///
/// Residuals that are equal on opposite sides of the centre (another blur, another shape, a light
/// gradient) do not displace it: only the antisymmetric part counts, which has half of the squares
/// of noise. Correlation between neighbours reduces the number of independent pixels: along rows
/// and columns, with geometrically falling correlation, by (1 + rho) / (1 - rho) each.
[[nodiscard]] double varianceInflation(const Window& window, int pixels);

}  // namespace lab::detector::fit
