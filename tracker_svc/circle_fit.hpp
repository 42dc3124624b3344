/// The centre of one black circle on a white cap, to a hundredth of a pixel.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>

#include "light/optics/grey_image.hpp"
#include "light/photometry/imaging.hpp"

namespace lab::detector {

/// The outline that a circle has in the picture: an ellipse around its centre. A pixel at offset
/// (dx, dy) from the centre lies inside where |M (dx, dy)| < 1.
struct DiscShape {
  float m[4] = {1, 0, 0, 1};  ///< M, row by row [1/px]

  bool operator==(const DiscShape&) const = default;

  /// Geometric mean of the half axes [px].
  [[nodiscard]] float radius() const {
    return 1.0F / std::sqrt(std::abs(m[0] * m[3] - m[1] * m[2]));
  }
};

/// Why a fit was not accepted.
enum class FitFault : std::uint8_t {
  kNone,
  kOutside,      ///< too near to the edge of the picture
  kLowContrast,  ///< not dark enough inside for the noise around
  kNotDark,      ///< inside is not the share of outside that black paint has
  kNotRound,     ///< the residuals say that this is something else
  kDiverged,     ///< the fit ran away from where it began
};

struct CircleFit {
  FitFault fault = FitFault::kNone;
  double x = 0;  ///< [px] centre
  double y = 0;
  std::array<double, 3> covariance{};  ///< [px^2] xx, xy, yy, with the floor from the residuals
  float white = 0;                     ///< [DN] of the cap at the centre
  float ratio = 0;        ///< [1] dark / white, black level taken off: about 0.08 at any light
  float ratio_error = 0;  ///< [1] its standard error
  float blur = 0;         ///< [px] standard deviation, pixel box included
  float residual = 0;     ///< [1] root mean square of the residuals over the expected noise
  float scale = 1;        ///< [1] fitted radius over the expected one
  bool edge = false;  ///< light that is no plane was fitted with it: an edge, or light that bends
  /// It is refused, but for nothing that light on top would not do: too little dark or residuals
  /// that go together, where size and contrast are right.
  bool glare = false;
};

/// Fits position, radius scale, blur, dark level and a tilted white plane under the given outline;
/// where the residuals ask for it, one or two light edges or light that bends as well
/// (circle_fit_edge.hpp). The covariance follows what the residuals say of the centre. Starts at
/// `start`; a start within a quarter of the radius of the centre leads to the same centre, to the
/// last bit (circle_fit_grid.hpp; with light edges across the circle nearly always).
///
/// (x, y) is the centre of the ellipse that the outline makes in the picture. The centre of the
/// circle itself appears up to a hundredth of a pixel beside it, by perspective: the caller's
/// business. `imaging` is a first guess only: blur is fitted, and the covariance follows the
/// residuals.
[[nodiscard]] CircleFit fitCircle(const optics::GreyView& picture, optics::Pixel start,
                                  const DiscShape& shape, const optics::Imaging& imaging);

/// The same where the outline depends on the place: as it is at the centre, to half a pixel,
/// wherever the fit starts.
/// @param shape_at gives the outline around a pixel
using ShapeAt = std::function<DiscShape(optics::Pixel)>;
[[nodiscard]] CircleFit fitCircle(const optics::GreyView& picture, optics::Pixel start,
                                  const ShapeAt& shape_at, const optics::Imaging& imaging);

}  // namespace lab::detector
