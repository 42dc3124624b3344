#pragma once

#include <algorithm>
#include <cmath>

namespace lab::analysis {

/// Means over independent windows, and their deviation from an expected value in standard errors.
struct WindowMoments {
  double n = 0;
  double r2 = 0;
  double r4 = 0;
  double r6 = 0;
  double r8 = 0;

  /// Adds the squared displacement or rotation of a window.
  void add(double square) {
    n += 1;
    r2 += square;
    r4 += square * square;
    r6 += square * square * square;
    r8 += square * square * square * square;
  }

  [[nodiscard]] double meanSquare() const { return r2 / n; }
  [[nodiscard]] double z(double expected) const {
    const double mean = r2 / n;
    return (mean - expected) / std::sqrt((r4 / n - mean * mean) / n);
  }

  [[nodiscard]] double kurtosis() const { return r4 * n / (r2 * r2); }
  /// The deviation of the kurtosis, by the delta method.
  [[nodiscard]] double kurtosisZ(double expected) const {
    const double m2 = r2 / n;
    const double m4 = r4 / n;
    const double var2 = m4 - m2 * m2;
    const double var4 = r8 / n - m4 * m4;
    const double cov = r6 / n - m2 * m4;
    const double by4 = 1 / (m2 * m2);
    const double by2 = -2 * m4 / (m2 * m2 * m2);
    const double variance = (by4 * by4 * var4 + by2 * by2 * var2 + 2 * by2 * by4 * cov) / n;
    return (kurtosis() - expected) / std::sqrt(variance);
  }
};

}  // namespace lab::analysis
