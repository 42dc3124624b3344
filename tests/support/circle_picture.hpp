/// Exact pictures of one circle, for the tests and the benchmark of the circle fit. Independent of
/// the fitted model: light and paint are multiplied on a grid of 4 x 4 points per pixel, blurred,
/// and averaged over each pixel.
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
  double hole_distance = 0;  ///< [px] from the centre to the hole; 0 for no hole
  double hole_radius = 0;    ///< [px]
  optics::Imaging imaging;
  double grain = 0.006;  ///< [1] standard deviation of each pixel's sensitivity
  /// Light at a place relative to full light; 1 everywhere if empty.
  std::function<double(double x, double y)> light;
  /// Paint outside the circle; white if empty.
  std::function<double(double x, double y)> around;
};

/// The picture without noise, row by row [DN], not clipped.
std::vector<double> paintExact(const CirclePicture& picture);

/// One exposure with grain, shot noise, read noise, rounding, and clipping at 0 and 255.
optics::GreyImage shoot(const CirclePicture& picture, std::mt19937_64& random);

/// One exposure of the result of paintExact().
optics::GreyImage shoot(const CirclePicture& picture, const std::vector<double>& exact,
                        std::mt19937_64& random);

/// An ellipse of mean radius `radius` [px]; the axis in direction `turn` [rad] is longer by the
/// factor `stretch`.
DiscShape roundShape(double radius, double stretch = 1, double turn = 0);

/// A smooth step from 0 to 1 at an edge, over about `width` [px] on each side.
double softStep(double distance, double width);

}  // namespace lab::detector::testing
