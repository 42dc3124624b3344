/// The disc of circle_fit_model.hpp where the light on it is no plane: the edge of a projected
/// pattern runs across it, one line, straight or slightly bent, or two straight ones (stripes, the
/// corner of a checker); or there is no edge, but the light bends (waves, noise). Internal to the
/// circle fit.
///
/// With lines the white level is W = sum of levels over their sides; a side is
///   E(z), z = (n d - offset + bend / 2 (t d)^2) / edge_sigma
/// with n the normal of the line, t along it. Paint is as dark a share of W on every side. The blur
/// of the product of light and paint is the product of both blurred and what a pixel's blur sees of
/// both steps at once: the two-dimensional normal distribution of z and of the paint's z, with the
/// correlation rho = cos(angle between line and outline) sigma / edge_sigma, by three terms of
///   phi(z1) phi(z2) sum of rho^n / n! He_(n-1)(z1) He_(n-1)(z2).
/// Without a line, W is a polynomial of third order, and the blur of the product has sigma^2 grad W
/// grad paint, as the first of these terms.
#pragma once

#include <array>
#include <cstddef>

#include "tracker_svc/circle_fit/circle_fit_model.hpp"

namespace lab::detector::fit {

struct Line {
  float nx = 1;  ///< the normal, of unit length
  float ny = 0;
  float offset = 0;  ///< [px] of the line from the origin of the window, along the normal
};

struct LitDisc {
  Disc disc;  ///< its white level is not used
  /// [DN] behind both lines, beyond the first, the second, both. Without a line: of the white level
  /// 1, uu, uv, vv, uuu, uuv, uvv, vvv with u = x / R, v = y / R
  std::array<float, 8> level{};
  std::array<Line, 2> line{};
  float bend = 0;        ///< [1/px] of the first line, where there is only one
  float edge_sigma = 1;  ///< [px] softness of the light edge in the picture
};

/// The order of the unknowns: seven of the disc, the levels, then, where there are lines, turn and
/// offset of each, the softness and, with one line, its bend.
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

/// All unknowns at `disc`, with residuals beyond `cutoff` expected deviations left out.
template <std::size_t kLines>
void sumLitDisc(Window& window, const Constants& constants, const LitDisc& disc, float cutoff,
                Sums<litUnknowns(kLines)>& sums);

}  // namespace lab::detector::fit
