/// Image model of a dark disc and the sums of its least-squares fit. Internal to the circle fit.
///
///   value = black + W(x, y) (ratio + (1 - ratio) Phi(z)),  W = white + slope_x dx + slope_y dy,
///   z = (sqrt(d' Q d + sigma^2) - R scale) / sigma,  d = (x, y) - centre,  Q = R^2 M' M,
///
/// with R the radius and M the outline of DiscShape. Phi(z) with this z is the convolution of a
/// disc with a round Gaussian, to second order in sigma / R (in the middle within 1 % for R > 1.5
/// sigma).
#pragma once

#include <array>
#include <cstddef>

#include "tracker_svc/circle_fit/circle_fit_window.hpp"

namespace lab::detector::fit {

/// Order of the unknowns. The first four change sign when the picture is rotated by 180 degrees,
/// the others do not, so the normal matrix separates into two 4 x 4 blocks up to small terms.
enum Unknown : std::size_t { kX, kY, kSlopeX, kSlopeY, kWhite, kScale, kRatio, kSigma };
constexpr std::size_t kUnknowns = 8;
constexpr std::size_t kBlock = 4;

constexpr float kUsualRatio = 0.08F;  ///< [1] dark / white, of black paint on white

/// Residuals well below this count fully in the cost [expected deviations].
constexpr float kLimit = 15;

struct Disc {
  float x = 0;  ///< [px] centre, relative to the window
  float y = 0;
  float white = 0;    ///< [DN] above black, at the origin of the window
  float slope_x = 0;  ///< [DN/px]
  float slope_y = 0;
  float scale = 1;  ///< [1] radius over that of the shape
  float ratio = 0;  ///< [1] dark / white
  float sigma = 1;  ///< [px] of all blur, pixel included
};

/// The outline as a symmetric matrix Q: d' Q d = R^2.
struct Outline {
  float xx = 1;
  float xy = 0;
  float yy = 1;

  /// Squared distance from the centre, scaled so that it is R^2 on the outline [px^2].
  [[nodiscard]] float squareAt(float dx, float dy) const {
    return dx * (xx * dx + xy * dy) + dy * (xy * dx + yy * dy);
  }
};

/// Constant within one fit.
struct Constants {
  Outline outline;           ///< Q
  float radius = 1;          ///< [px] R
  float black = 0;           ///< [DN]
  float floor_variance = 1;  ///< [DN^2] read noise and rounding
  float shot_gain = 0;       ///< [DN]
  bool compressed = false;   ///< errors of neighbouring pixels are correlated
  float texture = 0;         ///< [1] variance of the paint's and sensor's grain over signal^2

  /// Noise variance without grain at a signal above black [DN^2].
  [[nodiscard]] float noiseAt(float signal) const { return floor_variance + shot_gain * signal; }
};

/// Sums over the pixels.
struct Counts {
  double weight = 0;  ///< sum of the pixels' robust weights
  double pixels = 0;  ///< number of usable pixels
  double full = 0;    ///< number of saturated pixels, which are not used
  double cost = 0;    ///< sum of squared residuals, each limited to kLimit^2 / 3
};

template <std::size_t kCount>
struct Sums {
  static constexpr std::size_t kPairs = kCount * (kCount + 1) / 2;
  std::array<double, kPairs> normal{};  ///< lower triangle, row by row
  std::array<double, kCount> right{};
  double squares = 0;  ///< of the weighted residuals
  Counts counts;
};

/// One value per unknown, and per unknown of a block.
using Row = std::array<double, kUnknowns>;
using BlockRow = std::array<double, kBlock>;

/// The two blocks and the right sides at `disc`. Residuals beyond `cutoff` expected deviations have
/// weight 0 (Tukey's biweight). Leaves derivatives and inverse variances in window.slopes, and the
/// residuals in window.residual.
struct Blocks {                 // not zero-initialised, to save time
  std::array<double, 10> odd;   ///< x, y and the slopes: lower triangle
  std::array<double, 10> even;  ///< white, scale, ratio, sigma
  Row right;
  double squares;
  Counts counts;
};
void sumBlocks(Window& window, const Constants& constants, const Disc& disc, float cutoff,
               Blocks& blocks);

/// Remaining displacement of the centre from `disc`, and its scatter due to the residuals.
struct LastStep {
  double x = 0;  ///< [px] to be added
  double y = 0;
  std::array<double, 3> variance{};  ///< [px^2] xx, xy, yy: from the residuals
  double squares = 0;
  double weight = 0;  ///< sum of the lanes' robust weights; lanes without a usable
                      ///< pixel count as 1
  double cost = 0;    ///< as Counts::cost
};

/// The step of x and y alone after the small step `by`, with rows x and y of the inverse of the odd
/// block. The residuals are those of the previous pass, updated linearly; second order is
/// negligible after a small step. Leaves the weighted residuals in window.residual.
void sumLast(Window& window, const Row& by, float cutoff, const BlockRow& row_x,
             const BlockRow& row_y, LastStep& last);

/// Writes the light on white according to `disc` to window.light.
void layLight(Window& window, const Disc& disc);

/// Correlation of the residuals of neighbouring pixels: near 0 for noise, high if the picture
/// contains something that the model does not.
double correlation(const Window& window);

}  // namespace lab::detector::fit
