/// The disc of circle_fit_model.hpp where the edge of a projected pattern runs across it: one line,
/// straight or slightly bent, or two straight ones (stripes, the corner of a checker). Internal to
/// the circle fit.
///
/// The white level is W = sum of levels over the sides of the lines; a side is
///   E(z), z = (n d - offset + bend / 2 (t d)^2) / edge_sigma
/// with n the normal of the line, t along it. Paint is as dark a share of W on every side. The blur
/// of the product of light and paint is the product of both blurred plus sigma^2 grad W grad paint
/// (the first term of the series for a Gaussian blur; the next one is small for soft light edges).
#pragma once

#include <array>
#include <cstddef>

#include "tracker_svc/circle_fit_model.hpp"

namespace lab::tracker::fit {

struct Line {
  float nx = 1;  ///< the normal, of unit length
  float ny = 0;
  float offset = 0;  ///< [px] of the line from the origin of the window, along the normal
};

struct LitDisc {
  Disc disc;                     ///< its white level is not used
  std::array<float, 4> level{};  ///< [DN] behind both lines, beyond the first, the second, both
  std::array<Line, 2> line{};
  float bend = 0;        ///< [1/px] of the first line, where there is only one
  float edge_sigma = 1;  ///< [px] softness of the light edge in the picture
};

/// The order of the unknowns: seven of the disc, the levels, then turn and offset of each line, the
/// softness and, with one line, its bend.
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
constexpr std::size_t litUnknowns(std::size_t lines) { return lines == 1 ? 13 : 16; }
constexpr std::size_t levelsOf(std::size_t lines) { return 2 * lines; }

/// All unknowns at `disc`, with residuals beyond `cutoff` expected deviations left out.
template <std::size_t kLines>
void sumLitDisc(Window& window, const Constants& constants, const LitDisc& disc, float cutoff,
                Sums<litUnknowns(kLines)>& sums);

}  // namespace lab::tracker::fit
