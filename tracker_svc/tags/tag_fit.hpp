/// Fit of a tag's pattern to the picture: its pose with covariance.
#pragma once

#include <array>
#include <optional>

#include "light/optics/camera_model.hpp"
#include "light/optics/grey_image.hpp"
#include "light/optics/tag_pattern.hpp"
#include "light/photometry/imaging.hpp"

namespace lab::detector {

struct TagPose {
  double x = 0;                        ///< [m] centre
  double y = 0;                        ///< [m]
  double theta = 0;                    ///< [rad] from the centre to the right edge of the tag
  double size = 0;                     ///< [m] measured side of the square at the border
  std::array<double, 6> covariance{};  ///< [m^2, m rad, rad^2] xx, xy, xt, yy, yt, tt
  double white = 0;                    ///< [DN] of its white, without black level
  double contrast = 0;                 ///< [1] 1 - black / white
  double blur = 0;                     ///< [px] of its edges, with the pixel's square
  double chi2 = 0;                     ///< [1] mean square of the residuals over the noise
  double misfit = 0;                   ///< [1] rms of the residuals over white minus black
};

/// Fits pose, size, blur, contrast and the light, a polynomial of second order. All edges of the
/// pattern take part, so that the pose is more precise than that of the four corners. Residuals
/// above the camera's noise are part of the covariance.
/// @param start x, y, theta and size to begin with, off by at most half a cell
/// @param height [m] of the tag above the floor
/// @return empty if the tag is not completely in the picture, or if the fit diverges
[[nodiscard]] std::optional<TagPose> fitTag(const optics::GreyView& picture,
                                            const optics::CameraModel& camera,
                                            const optics::Imaging& imaging,
                                            const optics::TagPattern& pattern, double height,
                                            const TagPose& start);

}  // namespace lab::detector
