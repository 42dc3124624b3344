/// The fit in even light: a coarse step on a grid, then the eight unknowns of Disc. Internal to the
/// circle fit.
#pragma once

#include <array>
#include <memory>
#include <optional>

#include "light/photometry/imaging.hpp"
#include "tracker_svc/circle_fit/circle_fit_grid.hpp"
#include "tracker_svc/circle_fit/circle_fit_model.hpp"
#include "tracker_svc/circle_fit/circle_fit_pixels.hpp"

namespace lab::detector::fit {

/// Margin outside the outline [sigma]: wide enough to separate the slope of the light from a shift
/// of the circle; wider if an edge must be visible, or if not all pixels are used.
constexpr float kMargin = 3.5F;
constexpr float kMarginSparse = 4.5F;
constexpr float kMarginLit = 4.0F;

/// One circle to be fitted.
struct Task {
  const optics::GreyView* picture = nullptr;
  DiscShape shape;
  Constants constants;
  float sigma = 1;  ///< [px] of all blur, as far as known
  float margin_sigmas = kMargin;
  bool sparse = false;                        ///< omit pixels that contribute little
  std::shared_ptr<const PixelLayout> pixels;  ///< that are used

  Task(const optics::GreyView& the_picture, const DiscShape& the_shape,
       const optics::Imaging& imaging, bool is_sparse);
  bool setSigma(float the_sigma);             ///< @return whether the set of pixels changed
  bool setMargin(float sigmas);               ///< @return as above
  bool setSparse(bool is_sparse);             ///< @return as above
  bool setShape(const DiscShape& the_shape);  ///< @return as above
  /// Reads the pixels around the point. @return false if the outline would leave the picture
  bool gather(GridPoint point, Window& window) const;

 private:
  bool choosePixels();
};

/// Result of a fit, with or without light edges.
struct Outcome {
  bool good = false;
  double x = 0;  ///< [px] in the picture
  double y = 0;
  std::array<double, 3> covariance{};  ///< [px^2] xx, xy, yy
  double floor = 0;                    ///< [px^2] of xx and yy: what residuals do not show
  float white = 0;                     ///< [DN] at the centre
  float slope_x = 0;                   ///< [DN/px] of the white level, without light edges
  float slope_y = 0;
  float ratio = 0;
  float scale = 1;
  float sigma = 1;        ///< [px]
  float noise = 1;        ///< rms of the residuals over the expected noise
  float correlation = 0;  ///< of neighbouring residuals [1]
  float weight = 1;       ///< [1] share of the pixels
  float cost = 0;         ///< Sums::cost
  int pixels = 0;
  float ratio_error = 0;  ///< [1] standard error
};

/// Standard deviation of the residuals over the expected noise, corrected for the reduction by the
/// biweight.
float noiseOver(double squares, double freedom, bool robust);
constexpr float kCutoff = 5.0F;  ///< [expected deviations] above which the weight is 0
constexpr float kNoCutoff = 1e3F;

/// The centre's covariance: that of the expected noise, scaled by the residuals, plus the floor.
std::array<double, 3> covarianceOf(const std::array<double, 3>& expected,
                                   const std::array<double, 3>& scatter);

/// Finds the circle near `start` to a tenth of a pixel. @return its grid point
std::optional<GridPoint> settlePlain(const Task& task, GridPoint start, Window& window, Disc& disc);

/// The final fit from there; `window` and `disc` as settlePlain() left them.
Outcome fitPlain(const Task& task, Window& window, const Disc& rough);

}  // namespace lab::detector::fit
