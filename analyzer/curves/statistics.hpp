#pragma once

namespace lab::analysis {

/// The two-sided 95 % quantile of Student's t, 1.96 for many degrees of freedom; infinite below 1.
[[nodiscard]] double studentQuantile(double degrees_of_freedom);

/// The normal deviate that is as improbable as t is for Student's t with that many degrees of
/// freedom (Wallace's approximation).
[[nodiscard]] double normalDeviate(double t, double degrees_of_freedom);

/// P(F > f) of Fisher's F with these degrees of freedom (regularised incomplete beta function by
/// its continued fraction, good to 1e-12).
[[nodiscard]] double fisherTail(double f, double numerator_freedom, double denominator_freedom);

/// P(T^2 > t2) of Hotelling's T^2 in `dimensions` with a covariance estimated from other data with
/// that many degrees of freedom: what chi-square becomes when the covariance is not known exactly.
[[nodiscard]] double hotellingTail(double t2, int dimensions, double degrees_of_freedom);

/// The number of standard deviations that a normal deviate exceeds in size with probability p; at
/// most 40.
[[nodiscard]] double deviateOf(double p);

/// An interval of a Poisson mean.
struct Interval {
  double low = 0;
  double high = 0;
};

/// The 95 % interval of the mean of a Poisson count (the chi-square quantiles in the
/// Wilson-Hilferty approximation, good to 0.5 % from 2 counts on).
[[nodiscard]] Interval poissonInterval(double count);

}  // namespace lab::analysis
