/// Quantiles, tail probabilities and intervals.
#pragma once

namespace lab::analysis {

/// The two-sided 95 % quantile of Student's t; 1.96 for many degrees of freedom, infinite below 1.
[[nodiscard]] double studentQuantile(double degrees_of_freedom);

/// The same for any positive number of degrees of freedom, exactly.
[[nodiscard]] double studentQuantile95(double degrees_of_freedom);

/// The normal deviate with the same tail probability as the value t of Student's t with that many
/// degrees of freedom (Wallace's approximation).
[[nodiscard]] double normalDeviate(double t, double degrees_of_freedom);

/// P(F > f) for Fisher's F with these degrees of freedom. nan if f is nan.
[[nodiscard]] double fisherTail(double f, double numerator_freedom, double denominator_freedom);

/// P(T^2 > t2) for Hotelling's T^2 in `dimensions`, with a covariance estimated from other data
/// with that many degrees of freedom: chi-square, corrected for the error of the covariance. nan if
/// there are fewer degrees of freedom than dimensions.
[[nodiscard]] double hotellingTail(double t2, int dimensions, double degrees_of_freedom);

/// The number of standard deviations that a normal deviate exceeds in absolute value with
/// probability p; at most 40.
[[nodiscard]] double deviateOf(double p);

/// An interval of a Poisson mean.
struct Interval {
  double low = 0;
  double high = 0;
};

/// The 95 % interval of the mean of a Poisson count (chi-square quantiles in the Wilson-Hilferty
/// approximation, good to 0.5 % from 2 counts on).
[[nodiscard]] Interval poissonInterval(double count);

}  // namespace lab::analysis
