#include "analyzer/statistics.hpp"

#include <cmath>
#include <limits>

namespace lab::analysis {

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
