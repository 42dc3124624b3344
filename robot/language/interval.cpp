#include "robot/language/interval.hpp"

#include <algorithm>
#include <cmath>

namespace lab::language {
namespace {

double inRange(double x) { return std::clamp(x, -kLargestNumber, kLargestNumber); }

Interval limited(double low, double high, double sure_low, double sure_high) {
  Interval result(inRange(low), inRange(high));
  result.sure_low = std::clamp(sure_low, result.low, result.high);
  result.sure_high = std::clamp(sure_high, result.low, result.high);
  return result;
}

/// The inverse of an interval without 0.
Interval inverse(const Interval& a) {
  return limited(1 / a.high, 1 / a.low, 1 / a.sure_high, 1 / a.sure_low);
}

}  // namespace

Interval sum(const Interval& a, const Interval& b) {
  return limited(a.low + b.low, a.high + b.high, a.sure_low + b.sure_low,
                 a.sure_high + b.sure_high);
}

Interval negative(const Interval& a) { return limited(-a.high, -a.low, -a.sure_high, -a.sure_low); }

// Draws of both factors are independent, so each can have its sure value at the same time.
Interval product(const Interval& a, const Interval& b) {
  // If one factor has a known sign, it becomes `b`, and positive.
  if (b.low < 0 && b.high <= 0) return product(negative(a), negative(b));
  if (b.low < 0 && a.low >= 0) return product(b, a);
  if (b.low < 0 && a.high <= 0) return product(negative(b), negative(a));
  const auto [low, high] =
      std::minmax({a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high});
  if (b.low >= 0) {
    return limited(low, high, a.sure_low * (a.sure_low >= 0 ? b.sure_low : b.sure_high),
                   a.sure_high * (a.sure_high >= 0 ? b.sure_high : b.sure_low));
  }
  const auto both_signs = [](const Interval& x) { return x.sure_low <= 0 && x.sure_high >= 0; };
  if (!both_signs(a) || !both_signs(b)) return limited(low, high, high, low);
  return limited(low, high, std::min(a.sure_low * b.sure_high, a.sure_high * b.sure_low),
                 std::max(a.sure_low * b.sure_low, a.sure_high * b.sure_high));
}

Interval quotient(const Interval& a, const Interval& b) {
  if (!b.contains(0)) return product(a, inverse(b));
  if (b.low < 0 && b.high > 0) return bounds(-kLargestNumber, kLargestNumber);
  if (b.low < 0) return quotient(negative(a), negative(b));
  if (b.high == 0) return bounds(-kLargestNumber, kLargestNumber);
  // The divisor goes down to 0, where the result is the largest number, or 0 for 0 / 0.
  return bounds(a.low < 0 ? -kLargestNumber : a.low / b.high,
                a.high > 0 ? kLargestNumber : a.high / b.high);
}

Interval smaller(const Interval& a, const Interval& b) {
  return limited(std::min(a.low, b.low), std::min(a.high, b.high), std::min(a.sure_low, b.sure_low),
                 std::min(a.sure_high, b.sure_high));
}

Interval larger(const Interval& a, const Interval& b) {
  return limited(std::max(a.low, b.low), std::max(a.high, b.high), std::max(a.sure_low, b.sure_low),
                 std::max(a.sure_high, b.sure_high));
}

Interval absolute(const Interval& a) {
  if (a.low >= 0) return a;
  if (a.high <= 0) return negative(a);
  const double high = a.magnitude();
  // Whether draws come near 0 is not known.
  return limited(0, high, high, std::max({0.0, -a.sure_low, a.sure_high}));
}

Interval join(const Interval& a, const Interval& b) {
  return limited(std::min(a.low, b.low), std::max(a.high, b.high), std::min(a.sure_low, b.sure_low),
                 std::max(a.sure_high, b.sure_high));
}

Interval either(const Interval& a, const Interval& b) {
  return limited(std::min(a.low, b.low), std::max(a.high, b.high), std::max(a.sure_low, b.sure_low),
                 std::min(a.sure_high, b.sure_high));
}

Interval mapped(const Interval& a, double (*rising)(double)) {
  return limited(rising(a.low), rising(a.high), rising(a.sure_low), rising(a.sure_high));
}

Interval bounds(double low, double high) { return limited(low, high, high, low); }

}  // namespace lab::language
