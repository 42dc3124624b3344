#pragma once

namespace lab::language {

/// All values that a number of a program can have, in the units of programs.
struct Interval {
  double low = 0;
  double high = 0;
  /// Both ends are reached whatever the sensors and the history are. Otherwise they are bounds.
  bool attained = true;

  [[nodiscard]] bool isPoint() const { return low == high; }
  [[nodiscard]] bool contains(double x) const { return low <= x && x <= high; }
  /// The largest absolute value.
  [[nodiscard]] double magnitude() const { return -low > high ? -low : high; }
};

/// The largest number of the robot's arithmetic, 2^15.
constexpr double kLargestNumber = 32768;

/// Interval arithmetic, limited to the robot's numbers.
[[nodiscard]] Interval sum(const Interval& a, const Interval& b);
[[nodiscard]] Interval negative(const Interval& a);
[[nodiscard]] Interval product(const Interval& a, const Interval& b);
/// A divisor that can be 0 makes the quotient unbounded.
[[nodiscard]] Interval quotient(const Interval& a, const Interval& b);
[[nodiscard]] Interval smaller(const Interval& a, const Interval& b);
[[nodiscard]] Interval larger(const Interval& a, const Interval& b);
[[nodiscard]] Interval absolute(const Interval& a);
/// The smallest interval that contains both.
[[nodiscard]] Interval join(const Interval& a, const Interval& b);
/// The same ends, which need not be reached.
[[nodiscard]] Interval bounds(double low, double high);

}  // namespace lab::language
