/// The disc of circle_fit_model.hpp under light that is not a plane: edges of a projected pattern
/// run across it (one line, straight or slightly bent, or two straight lines: stripes, the corner
/// of a checkerboard), or the light varies smoothly (waves, noise). Internal to the circle fit.
///
/// With lines the white level is W = sum of levels over the regions between them; a region is
/// bounded by
///   E(z), z = (n d - offset + bend / 2 (t d)^2) / edge_sigma
/// with n the normal of the line and t its direction. The ratio of dark to white paint is the same
/// in all regions. The blur of the product of light and paint is the product of the blurred factors
/// plus a term for pixels that see both steps: the bivariate normal distribution of z and of the
/// paint's z, with the correlation rho = cos(angle between line and outline) sigma / edge_sigma, by
/// three terms of
///   phi(z1) phi(z2) sum of rho^n / n! He_(n-1)(z1) He_(n-1)(z2).
/// Without a line, W is a polynomial of third order, and the blur of the product adds sigma^2 grad
/// W grad paint, the first of these terms.
#pragma once

#include <array>
#include <cstddef>

#include "tracker_svc/circle_fit/circle_fit_model.hpp"

namespace lab::detector::fit {

struct Line {
  float nx = 1;  ///< unit normal
  float ny = 0;
  float offset = 0;  ///< [px] distance of the line from the window's origin along the normal
};

struct LitDisc {
  Disc disc;  ///< its white level is not used
  /// [DN] of the regions: behind both lines, beyond the first, the second, both. Without a line:
  /// coefficients of 1, uu, uv, vv, uuu, uuv, uvv, vvv with u = x / R, v = y / R.
  std::array<float, 8> level{};
  std::array<Line, 2> line{};
  float bend = 0;        ///< [1/px] curvature of a single line
  float edge_sigma = 1;  ///< [px] blur of the light edge in the picture
};

/// Order of the unknowns: seven of the disc, the levels, then, with lines, the rotation and offset
/// of each, the edge's blur and, with one line, its bend.
enum LitUnknown : std::size_t {
  kLitX,
  kLitY,
  kLitSlopeX,
  kLitSlopeY,
  kLitScale,
  kLitRatio,
  kLitSigma,
  kLitLevel
};
constexpr std::size_t levelsOf(std::size_t lines) { return lines == 0 ? 8 : 2 * lines; }
constexpr std::size_t litUnknowns(std::size_t lines) {
  return lines == 0 ? 15 : lines == 1 ? 13 : 16;
}

/// Normal equations of all unknowns at `disc`; residuals above `cutoff` expected deviations are
/// omitted.
template <std::size_t kLines>
void sumLitDisc(Window& window, const Constants& constants, const LitDisc& disc, float cutoff,
                Sums<litUnknowns(kLines)>& sums);

}  // namespace lab::detector::fit
