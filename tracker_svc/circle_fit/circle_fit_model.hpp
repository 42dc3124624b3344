/// What a dark disc looks like in a picture, and the sums of its least squares. Internal to the
/// circle fit.
///
///   value = black + W(x, y) (ratio + (1 - ratio) Phi(z)),  W = white + slope_x dx + slope_y dy,
///   z = (sqrt(d' Q d + sigma^2) - R scale) / sigma,  d = (x, y) - centre,  Q = R^2 M' M,
///
/// with R the radius and M the outline of DiscShape. Phi(z) with that z is the share of a disc
/// under a round Gaussian to second order in sigma / R (exact in the middle to 1 % for R > 1.5
/// sigma).
#pragma once

#include <array>
#include <cstddef>

#include "tracker_svc/circle_fit/circle_fit_window.hpp"

namespace lab::detector::fit {

/// The order of the unknowns. The first four change sign when the picture is turned by half a turn,
/// the others do not: so the normal matrix falls into two blocks of four, but for little.
enum Unknown : std::size_t { kX, kY, kSlopeX, kSlopeY, kWhite, kScale, kRatio, kSigma };
constexpr std::size_t kUnknowns = 8;
constexpr std::size_t kBlock = 4;

constexpr float kUsualRatio = 0.08F;  ///< [1] dark / white, of black paint on white

/// Residuals count fully in the cost while they are small against this [expected deviations].
constexpr float kLimit = 15;

struct Disc {
  float x = 0;  ///< [px] centre, relative to the window
  float y = 0;
  float white = 0;    ///< [DN] above black, at the origin of the window
  float slope_x = 0;  ///< [DN/px]
  float slope_y = 0;
  float scale = 1;  ///< [1] radius over that of the shape
  float ratio = 0;  ///< [1] dark / white
  float sigma = 1;  ///< [px] of the whole blur
};

/// The outline as a symmetric matrix Q: where d' Q d = R^2.
struct Outline {
  float xx = 1;
  float xy = 0;
  float yy = 1;

  /// Square of the distance from the centre, where the outline is R away [px^2].
  [[nodiscard]] float squareAt(float dx, float dy) const {
    return dx * (xx * dx + xy * dy) + dy * (xy * dx + yy * dy);
  }
};

/// What does not change within one fit.
struct Constants {
  Outline outline;           ///< Q
  float radius = 1;          ///< [px] R
  float black = 0;           ///< [DN]
  float floor_variance = 1;  ///< [DN^2] read noise and rounding
  float shot_gain = 0;       ///< [DN]
  bool compressed = false;   ///< neighbouring pixels share errors
  float texture = 0;         ///< [1] variance of the paint's and sensor's grain over signal^2

  /// What a sensor without grain has at a signal above black [DN^2].
  [[nodiscard]] float noiseAt(float signal) const { return floor_variance + shot_gain * signal; }
};

/// What is counted over the pixels.
struct Counts {
  double weight = 0;  ///< number of pixels, counted by how far they are believed
  double pixels = 0;  ///< number of pixels that could be used
  double full = 0;    ///< number of pixels that were not, because they are full
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

/// One value for each unknown, and for the unknowns of a block.
using Row = std::array<double, kUnknowns>;
using BlockRow = std::array<double, kBlock>;

/// The two blocks and the right sides at `disc`. Residuals beyond `cutoff` expected deviations
/// count for nothing (Tukey's biweight). Leaves slopes and certainty in window.slopes, and the
/// residuals in window.residual.
struct Blocks {                 // not set to zero beforehand, which takes time
  std::array<double, 10> odd;   ///< x, y and the slopes: lower triangle
  std::array<double, 10> even;  ///< white, scale, ratio, sigma
  Row right;
  double squares;
  Counts counts;
};
void sumBlocks(Window& window, const Constants& constants, const Disc& disc, float cutoff,
               Blocks& blocks);

/// How far the centre still is from where `disc` has it, and how the residuals scatter it.
struct LastStep {
  double x = 0;  ///< [px] to be added
  double y = 0;
  std::array<double, 3> variance{};  ///< [px^2] xx, xy, yy: the residuals' own
  double squares = 0;
  double weight = 0;  ///< number of lanes, counted by how far they are believed; those without a
                      ///< pixel, or with one that tells nothing, count fully
  double cost = 0;    ///< as Counts::cost
};

/// The step of x and y alone after the small step `by`, with rows x and y of the inverse of the odd
/// block. The residuals are those of the pass before, changed by the slopes: second order is
/// nothing where the step was small. Leaves the believed residuals in window.residual.
void sumLast(Window& window, const Row& by, float cutoff, const BlockRow& row_x,
             const BlockRow& row_y, LastStep& last);

/// The light on white by `disc`, to window.light.
void layLight(Window& window, const Disc& disc);

/// Correlation of the residuals of neighbouring pixels: near 0 for noise, high where something that
/// is not in the model is there.
double correlation(const Window& window);

}  // namespace lab::detector::fit
