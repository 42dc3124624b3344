/// Pictures of one circle, painted exactly: for the tests and the benchmark of the circle fit.
/// Shares nothing with the model that is fitted: light and paint are multiplied on a grid of 4 x 4
/// points a pixel, then blurred, then averaged over each pixel.
#pragma once

#include <functional>
#include <random>
#include <vector>

#include "light/optics/grey_image.hpp"
#include "light/photometry/imaging.hpp"
#include "tracker_svc/circle_fit.hpp"

namespace lab::detector::testing {

struct CirclePicture {
  int size = 48;             ///< [px] square
  double x = 24, y = 24;     ///< [px] centre of the circle
  DiscShape shape;           ///< its outline
  double ratio = 0.0814;     ///< black paint / white paint
  double white = 190;        ///< [DN] of the cap in full light, above black
  double sensor_hole = 0;    ///< [rad] direction of the hole in the cap
  double hole_distance = 0;  ///< [px] of the hole from the centre; 0: no hole
  double hole_radius = 0;    ///< [px]
  optics::Imaging imaging;
  double grain = 0.006;  ///< [1] standard deviation of each pixel's sensitivity
  /// Light at a place relative to full light; empty: 1 everywhere.
  std::function<double(double x, double y)> light;
  /// Paint at a place where there is no circle; empty: white.
  std::function<double(double x, double y)> around;
};

/// The picture without noise, [DN] row by row, not clipped.
std::vector<double> paintExact(const CirclePicture& picture);

/// One shot of it: grain, shot noise, read noise, rounding, clipping at 0 and 255.
optics::GreyImage shoot(const CirclePicture& picture, std::mt19937_64& random);

/// Another shot of what paintExact() gave.
optics::GreyImage shoot(const CirclePicture& picture, const std::vector<double>& exact,
                        std::mt19937_64& random);

/// An outline of this radius [px], its axis in direction `turn` longer by `stretch`.
DiscShape roundShape(double radius, double stretch = 1, double turn = 0);

/// 0 left of an edge, 1 right of it, soft over about `width` [px] on each side.
double softStep(double distance, double width);

}  // namespace lab::detector::testing
