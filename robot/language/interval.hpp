#pragma once

namespace lab::language {

/// All values that a number of a program can have, in the units of programs.
struct Interval {
  double low = 0;
  double high = 0;
  /// Whatever the sensors and the history are, some draw gives a value of at most `sure_low`, and
  /// some draw one of at least `sure_high`. Of a constant and a uniform draw these are the ends; of
  /// a sensor, which may stay at either end, they are the opposite ends.
  double sure_low = 0;
  double sure_high = 0;

  constexpr Interval() = default;
  /// @param attained draws reach both ends, whatever the sensors and the history are
  constexpr Interval(double from, double to, bool attained = true)
      : low(from), high(to), sure_low(attained ? from : to), sure_high(attained ? to : from) {}

  [[nodiscard]] bool isAttained() const { return sure_low == low && sure_high == high; }
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
/// A divisor that can be 0 makes the quotient unbounded, on one side if its sign is known.
[[nodiscard]] Interval quotient(const Interval& a, const Interval& b);
[[nodiscard]] Interval smaller(const Interval& a, const Interval& b);
[[nodiscard]] Interval larger(const Interval& a, const Interval& b);
[[nodiscard]] Interval absolute(const Interval& a);
/// A draw between both, or one of both by a draw.
[[nodiscard]] Interval join(const Interval& a, const Interval& b);
/// One of both, which sensors and history select.
[[nodiscard]] Interval either(const Interval& a, const Interval& b);
/// The results of a function that never falls.
[[nodiscard]] Interval mapped(const Interval& a, double (*rising)(double));
/// The same ends, which need not be reached.
[[nodiscard]] Interval bounds(double low, double high);

}  // namespace lab::language
