#pragma once

#include <complex>
#include <numbers>

namespace lab::analysis {

/// The turning angle D of a tumble, by the moments that the laws depend on.
struct Turning {
  double mean = 0;                                               ///< <D>, rad, not wrapped.
  double mean_square = std::numbers::pi * std::numbers::pi / 3;  ///< <D^2>, rad^2.
  std::complex<double> z = 0;                                    ///< <exp(i D)>.

  /// Uniform on [low, high] (rad). The default is the full circle, (-pi, pi].
  static Turning uniform(double low, double high);

  /// The same for wheels that turn the robot by at most `limit` (rad, > 0) in a tumble: larger
  /// angles are clipped.
  static Turning clipped(double low, double high, double limit);
};

}  // namespace lab::analysis
