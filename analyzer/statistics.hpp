#pragma once

namespace lab::analysis {

/// The two-sided 95 % quantile of Student's t, 1.96 for many degrees of freedom; infinite below 1.
[[nodiscard]] double studentQuantile(double degrees_of_freedom);

/// The normal deviate that is as improbable as t is for Student's t with that many degrees of
/// freedom (Wallace's approximation).
[[nodiscard]] double normalDeviate(double t, double degrees_of_freedom);

/// An interval of a Poisson mean.
struct Interval {
  double low = 0;
  double high = 0;
};

/// The 95 % interval of the mean of a Poisson count (the chi-square quantiles in the
/// Wilson-Hilferty approximation, good to 0.5 % from 2 counts on).
[[nodiscard]] Interval poissonInterval(double count);

}  // namespace lab::analysis
