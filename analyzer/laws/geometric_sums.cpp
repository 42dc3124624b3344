#include "analyzer/laws/geometric_sums.hpp"

#include <cmath>

namespace lab::analysis {

GeometricSums geometricSums(double q, double n) {
  const double p = 1 - q;
  GeometricSums sums;
  if (n * p < 1e-6) {  // series to first order in p: the closed form would lose its digits
    sums.plain = n * (1 - 0.5 * (n - 1) * p);
    sums.weighted = 0.5 * n * (n - 1) * (1 - (n - 2) * p / 3);
    return sums;
  }
  sums.plain = q > 0 ? -std::expm1(n * std::log1p(-p)) / p : (1 - std::pow(q, n)) / p;
  sums.weighted = (n - sums.plain) / p;
  return sums;
}

double sumOverHoldPairs(double first, double full_hold, double last, double n, double q) {
  const GeometricSums sums = geometricSums(q, n);
  return full_hold * (first + last) * sums.plain + first * last * std::pow(q, n) +
         full_hold * full_hold * sums.weighted;
}

}  // namespace lab::analysis
