#include "analyzer/curves/statistics.hpp"

#include <cmath>
#include <limits>

namespace lab::analysis {
namespace {

/// The continued fraction of the incomplete beta function by Lentz's method (converges fast for
/// x < (a + 1) / (a + b + 2)).
double betaFraction(double a, double b, double x) {
  constexpr double kTiny = 1e-300;
  constexpr int kMostTerms = 500;
  const auto safe = [](double value) { return std::abs(value) < kTiny ? kTiny : value; };
  double c = 1;
  double d = 1 / safe(1 - (a + b) * x / (a + 1));
  double fraction = d;
  for (int m = 1; m <= kMostTerms; ++m) {
    const auto step = [&](double coefficient) {
      d = 1 / safe(1 + coefficient * d);
      c = safe(1 + coefficient / c);
      fraction *= c * d;
      return c * d;
    };
    step(m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)));
    if (std::abs(step(-(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))) - 1) < 1e-15) {
      break;
    }
  }
  return fraction;
}

/// The regularised incomplete beta function I_x(a, b).
double incompleteBeta(double a, double b, double x) {
  if (!(x > 0)) return 0;
  if (!(x < 1)) return 1;
  const double front = std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) +
                                a * std::log(x) + b * std::log1p(-x));
  return x < (a + 1) / (a + b + 2) ? front * betaFraction(a, b, x) / a
                                   : 1 - front * betaFraction(b, a, 1 - x) / b;
}

}  // namespace

double fisherTail(double f, double numerator_freedom, double denominator_freedom) {
  if (!(f > 0)) return std::isnan(f) ? f : 1;
  const double x = denominator_freedom / (denominator_freedom + numerator_freedom * f);
  return incompleteBeta(0.5 * denominator_freedom, 0.5 * numerator_freedom, x);
}

double hotellingTail(double t2, int dimensions, double degrees_of_freedom) {
  const double rest = degrees_of_freedom - dimensions + 1;
  if (dimensions < 1 || !(rest > 0)) return std::numeric_limits<double>::quiet_NaN();
  return fisherTail(t2 * rest / (degrees_of_freedom * dimensions), dimensions, rest);
}

double deviateOf(double p) {
  if (std::isnan(p)) return p;
  double low = 0;
  double high = 40;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (std::erfc(middle / std::sqrt(2.0)) >= p ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double studentQuantile(double degrees_of_freedom) {
  if (degrees_of_freedom < 1) {
    return std::numeric_limits<double>::infinity();
  }
  if (degrees_of_freedom < 2) {
    return 12.706;
  }
  if (degrees_of_freedom < 3) {
    return 4.303;
  }
  // Expansion in 1/nu (Abramowitz and Stegun 26.7.5) at the normal quantile.
  const double x = 1.959964;
  const double x2 = x * x;
  const double nu = degrees_of_freedom;
  const double g1 = x * (x2 + 1) / 4;
  const double g2 = x * ((5 * x2 + 16) * x2 + 3) / 96;
  const double g3 = x * (((3 * x2 + 19) * x2 + 17) * x2 - 15) / 384;
  const double g4 = x * ((((79 * x2 + 776) * x2 + 1482) * x2 - 1920) * x2 - 945) / 92160;
  return x + (g1 + (g2 + (g3 + g4 / nu) / nu) / nu) / nu;
}

double normalDeviate(double t, double degrees_of_freedom) {
  const double nu = degrees_of_freedom;
  return std::copysign((8 * nu + 1) / (8 * nu + 3) * std::sqrt(nu * std::log1p(t * t / nu)), t);
}

Interval poissonInterval(double count) {
  const auto halfChiSquare = [](double half_dof, double z) {
    const double spread = 1 / (9 * half_dof);
    const double root = 1 - spread + z * std::sqrt(spread);
    return half_dof * root * root * root;
  };
  Interval interval;
  interval.low = count > 0 ? halfChiSquare(count, -1.959964) : 0.0;
  interval.high = halfChiSquare(count + 1, 1.959964);
  return interval;
}

}  // namespace lab::analysis
