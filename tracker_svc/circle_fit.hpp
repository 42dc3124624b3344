/// Sub-pixel fit of one black circle on a white cap, accurate to a hundredth of a pixel.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>

#include "light/optics/grey_image.hpp"
#include "light/photometry/imaging.hpp"

namespace lab::detector {

/// The outline of a circle in the picture: an ellipse around its centre. A pixel at offset (dx, dy)
/// from the centre lies inside if |M (dx, dy)| < 1.
struct DiscShape {
  float m[4] = {1, 0, 0, 1};  ///< M, row by row [1/px]

  bool operator==(const DiscShape&) const = default;

  /// Geometric mean of the half axes [px].
  [[nodiscard]] float radius() const {
    return 1.0F / std::sqrt(std::abs(m[0] * m[3] - m[1] * m[2]));
  }
};

/// Why a fit was rejected.
enum class FitFault : std::uint8_t {
  kNone,
  kOutside,      ///< too close to the edge of the picture
  kLowContrast,  ///< too little contrast for the noise
  kNotDark,      ///< dark / white is too high for black paint
  kNotRound,     ///< the residuals do not fit a circle
  kDiverged,     ///< the fit moved too far from its start
};

struct CircleFit {
  FitFault fault = FitFault::kNone;
  double x = 0;  ///< [px] centre
  double y = 0;
  std::array<double, 3> covariance{};  ///< [px^2] xx, xy, yy, including what the residuals add
  float white = 0;                     ///< [DN] of the cap at the centre
  float ratio = 0;        ///< [1] dark / white, black level subtracted: about 0.08 for black paint
  float ratio_error = 0;  ///< [1] its standard error
  float blur = 0;         ///< [px] standard deviation, pixel box included
  float residual = 0;     ///< [1] root mean square of the residuals over the expected noise
  float scale = 1;        ///< [1] fitted radius over the expected one
  bool edge = false;  ///< an uneven light model was fitted too: a light edge or a light gradient
  /// The fit is rejected only for faults that glare explains: too little contrast or correlated
  /// residuals, while size and contrast sign are right.
  bool glare = false;
};

/// Fits position, radius scale, blur, dark level and a tilted white plane under the given outline;
/// if the residuals require it, also one or two light edges or a light gradient
/// (circle_fit_edge.hpp). The covariance includes the effect of the residuals on the centre. Starts
/// at `start`; all starts within a quarter of the radius of the centre give bit-equal centres
/// (circle_fit_grid.hpp), with rare exceptions where light edges cross the circle.
///
/// (x, y) is the centre of the ellipse in the picture. The image of the circle's own centre differs
/// by up to a hundredth of a pixel because of perspective; the caller corrects this. `imaging` is
/// only a first estimate: blur is fitted, and the covariance follows the residuals.
[[nodiscard]] CircleFit fitCircle(const optics::GreyView& picture, optics::Pixel start,
                                  const DiscShape& shape, const optics::Imaging& imaging);

/// The same for an outline that depends on the place. The outline at the centre is used, to half a
/// pixel, wherever the fit starts.
/// @param shape_at returns the outline around a pixel
using ShapeAt = std::function<DiscShape(optics::Pixel)>;
[[nodiscard]] CircleFit fitCircle(const optics::GreyView& picture, optics::Pixel start,
                                  const ShapeAt& shape_at, const optics::Imaging& imaging);

}  // namespace lab::detector
