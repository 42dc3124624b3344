// Tail probabilities are Boost's. The approximations of studentQuantile, normalDeviate and
// poissonInterval are kept: their bits are part of the ANALYSIS messages in logs of virtual time.
#include "analyzer/curves/statistics.hpp"

#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/beta.hpp>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/math/units.hpp"

namespace lab::analysis {

double fisherTail(double f, double numerator_freedom, double denominator_freedom) {
  if (std::isnan(f)) return f;
  if (f <= 0) return 1;
  // cdf(complement(fisher_f)) of Boost, which refuses an infinite f.
  const double x = denominator_freedom / (denominator_freedom + numerator_freedom * f);
  return boost::math::ibeta(0.5 * denominator_freedom, 0.5 * numerator_freedom, x);
}

double hotellingTail(double t2, int dimensions, double degrees_of_freedom) {
  const double rest = degrees_of_freedom - dimensions + 1;
  if (dimensions < 1 || !(rest > 0)) return units::kNan;
  return fisherTail(t2 * rest / (degrees_of_freedom * dimensions), dimensions, rest);
}

double deviateOf(double p) {
  constexpr double kLargest = 40;
  if (std::isnan(p)) return p;
  if (p <= 0) return kLargest;
  if (p >= 1) return 0;
  return std::min(kLargest, std::numbers::sqrt2 * boost::math::erfc_inv(p));
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

double studentQuantile95(double degrees_of_freedom) {
  if (!(degrees_of_freedom > 0)) return std::numeric_limits<double>::infinity();
  return boost::math::quantile(boost::math::students_t(degrees_of_freedom), 0.975);
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
