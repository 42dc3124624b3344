#include "analyzer/laws/chebyshev.hpp"

#include <cmath>
#include <numbers>

namespace lab::analysis {

ChebyshevSeries::ChebyshevSeries(const std::vector<double>& values, double length)
    : length_(length) {
  const std::size_t n = values.size();
  // All angles are multiples of pi / (2 n). Kept, because the laws use the same few sizes.
  thread_local std::vector<double> cosines;
  if (cosines.size() != 4 * n) {
    cosines.resize(4 * n);
    for (std::size_t k = 0; k < 4 * n; ++k) {
      cosines[k] = std::cos(std::numbers::pi * static_cast<double>(k) / static_cast<double>(2 * n));
    }
  }
  coefficients_.resize(n);
  for (std::size_t j = 0; j < n; ++j) {
    double sum = 0;
    std::size_t angle = j;  // j (2 i + 1) modulo 4 n
    for (std::size_t i = 0; i < n; ++i) {
      sum += values[i] * cosines[angle];
      angle += 2 * j;
      if (angle >= 4 * n) angle -= 4 * n;
    }
    coefficients_[j] = (j == 0 ? 1.0 : 2.0) * sum / static_cast<double>(n);
  }
}

std::vector<double> ChebyshevSeries::points(double length, int count) {
  std::vector<double> points;
  for (int i = 0; i < count; ++i) {
    points.push_back(0.5 * length * (1 + std::cos(std::numbers::pi * (i + 0.5) / count)));
  }
  return points;
}

double ChebyshevSeries::operator()(double x) const {
  // Clenshaw's recurrence.
  const double y = 2 * x / length_ - 1;
  double b1 = 0;
  double b2 = 0;
  for (std::size_t j = coefficients_.size() - 1; j > 0; --j) {
    const double b0 = coefficients_[j] + 2 * y * b1 - b2;
    b2 = b1;
    b1 = b0;
  }
  return coefficients_[0] + y * b1 - b2;
}

ChebyshevSeries ChebyshevSeries::integral() const {
  const std::size_t n = coefficients_.size();
  auto at = [this, n](std::size_t j) { return j < n ? coefficients_[j] : 0.0; };
  ChebyshevSeries result;
  result.length_ = length_;
  result.coefficients_.assign(n + 1, 0.0);
  for (std::size_t j = 1; j <= n; ++j) {
    const double lower = j == 1 ? 2 * at(0) : at(j - 1);
    result.coefficients_[j] = 0.5 * length_ * (lower - at(j + 1)) / (2 * static_cast<double>(j));
  }
  result.coefficients_[0] = -result(0);
  return result;
}

GaussRule gaussLegendre(int n) {
  GaussRule rule;
  for (int i = 0; i < n; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5));
    double derivative = 0;
    for (int iteration = 0; iteration < 100; ++iteration) {
      double previous = 1;
      double current = x;
      for (int k = 2; k <= n; ++k) {
        const double next = ((2 * k - 1) * x * current - (k - 1) * previous) / k;
        previous = current;
        current = next;
      }
      derivative = n * (x * current - previous) / (x * x - 1);
      const double step = current / derivative;
      x -= step;
      if (std::abs(step) < 1e-15) {
        break;
      }
    }
    rule.nodes.push_back(0.5 * (1 - x));
    rule.weights.push_back(1 / ((1 - x * x) * derivative * derivative));
  }
  return rule;
}

}  // namespace lab::analysis
