/// The fit in even light: a rough step on a grid, then the eight unknowns of Disc. Internal to the
/// circle fit.
#pragma once

#include <array>
#include <memory>

#include "light/photometry/imaging.hpp"
#include "tracker_svc/circle_fit/circle_fit_grid.hpp"
#include "tracker_svc/circle_fit/circle_fit_model.hpp"
#include "tracker_svc/circle_fit/circle_fit_pixels.hpp"

namespace lab::detector::fit {

/// Outside the outline: wide, since the slopes of the light must be told from a shift of the
/// circle; wider where an edge must be seen, or where not all pixels are looked at. [deviations of
/// the blur]
constexpr float kMargin = 3.5F;
constexpr float kMarginSparse = 4.5F;
constexpr float kMarginLit = 4.0F;

/// One circle to be fitted.
struct Task {
  const optics::GreyView* picture = nullptr;
  DiscShape shape;
  Constants constants;
  float sigma = 1;  ///< [px] the whole blur, as far as known
  float margin_sigmas = kMargin;
  bool sparse = false;                        ///< without pixels that tell little
  std::shared_ptr<const PixelLayout> pixels;  ///< that are looked at

  Task(const optics::GreyView& the_picture, const DiscShape& the_shape,
       const optics::Imaging& imaging, bool is_sparse);
  bool setSigma(float the_sigma);             ///< @return whether other pixels are looked at now
  bool setMargin(float sigmas);               ///< @return as above
  bool setSparse(bool is_sparse);             ///< @return as above
  bool setShape(const DiscShape& the_shape);  ///< @return as above
  /// The pixels around the point. @return false where the outline would leave the picture
  bool gather(GridPoint point, Window& window) const;

 private:
  bool choosePixels();
};

/// What a fit found, with or without light edges.
struct Outcome {
  bool good = false;
  double x = 0;  ///< [px] in the picture
  double y = 0;
  std::array<double, 3> covariance{};  ///< [px^2] xx, xy, yy
  double floor = 0;                    ///< [px^2] of xx and yy: what no residual shows
  float white = 0;                     ///< [DN] at the centre
  float slope_x = 0;                   ///< [DN/px] of the white level, without light edges
  float slope_y = 0;
  float ratio = 0;
  float scale = 1;
  float sigma = 1;        ///< [px]
  float noise = 1;        ///< residuals over the expected noise
  float correlation = 0;  ///< of neighbouring residuals
  float weight = 1;       ///< [1] share of the pixels
  float cost = 0;         ///< Sums::cost
  int pixels = 0;
  float ratio_error = 0;  ///< [1] standard error
};

/// Deviation of the residuals over the expected noise. The biweight takes some off, which is put
/// back.
float noiseOver(double squares, double freedom, bool robust);
constexpr float kCutoff = 5.0F;  ///< [expected deviations] farther off is not of the model
constexpr float kNoCutoff = 1e3F;

/// The centre's covariance: that of the expected noise, with the size that the residuals say, and
/// the floor.
std::array<double, 3> covarianceOf(const std::array<double, 3>& expected,
                                   const std::array<double, 3>& scatter);

/// Where the circle near `start` is, to a tenth of a pixel, as a point of the grid.
std::optional<GridPoint> settlePlain(const Task& task, GridPoint start, Window& window, Disc& disc);

/// The fit from there; `window` and `disc` as settlePlain() left them.
Outcome fitPlain(const Task& task, Window& window, const Disc& rough);

}  // namespace lab::detector::fit
