/// Chebyshev series and Gauss-Legendre rules. Own code: Boost has no series from given values and
/// no rule whose size is chosen at run time, and the bits of the exact laws must not change.
#pragma once

#include <vector>

namespace lab::analysis {

/// A smooth function on an interval [0, length] as a Chebyshev series. It is evaluated in one short
/// sum and integrated exactly.
class ChebyshevSeries {
 public:
  /// The zero function on [0, 1].
  ChebyshevSeries() : coefficients_(1, 0.0) {}

  /// Interpolates the values of a function at points(length, values.size()). For a function without
  /// singularities the error falls faster than any power of the number of points.
  ChebyshevSeries(const std::vector<double>& values, double length);

  /// The Chebyshev points of [0, length].
  [[nodiscard]] static std::vector<double> points(double length, int count);

  /// The value at x in [0, length].
  [[nodiscard]] double operator()(double x) const;

  /// The function F(x) = int_0^x f.
  [[nodiscard]] ChebyshevSeries integral() const;

 private:
  std::vector<double> coefficients_;
  double length_ = 1;
};

/// Nodes and weights of the Gauss-Legendre rule on [0, 1].
struct GaussRule {
  std::vector<double> nodes;
  std::vector<double> weights;
};

/// The n-point Gauss-Legendre rule on [0, 1], by Newton iteration to full precision.
[[nodiscard]] GaussRule gaussLegendre(int n);

}  // namespace lab::analysis
