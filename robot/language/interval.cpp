#include "robot/language/interval.hpp"

#include <algorithm>
#include <cmath>

namespace lab::language {
namespace {

Interval limited(double low, double high, bool attained) {
  return {std::clamp(low, -kLargestNumber, kLargestNumber),
          std::clamp(high, -kLargestNumber, kLargestNumber), attained};
}

}  // namespace

Interval sum(const Interval& a, const Interval& b) {
  return limited(a.low + b.low, a.high + b.high, a.attained && b.attained);
}

Interval negative(const Interval& a) { return {-a.high, -a.low, a.attained}; }

Interval product(const Interval& a, const Interval& b) {
  const auto [low, high] =
      std::minmax({a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high});
  return limited(low, high, a.attained && b.attained);
}

Interval quotient(const Interval& a, const Interval& b) {
  if (b.contains(0)) {
    return bounds(-kLargestNumber, kLargestNumber);
  }
  return product(a, {1 / b.high, 1 / b.low, b.attained});
}

Interval smaller(const Interval& a, const Interval& b) {
  return {std::min(a.low, b.low), std::min(a.high, b.high), a.attained && b.attained};
}

Interval larger(const Interval& a, const Interval& b) {
  return {std::max(a.low, b.low), std::max(a.high, b.high), a.attained && b.attained};
}

Interval absolute(const Interval& a) {
  const double low = a.contains(0) ? 0 : std::min(std::abs(a.low), std::abs(a.high));
  return {low, a.magnitude(), a.attained};
}

Interval join(const Interval& a, const Interval& b) {
  return {std::min(a.low, b.low), std::max(a.high, b.high), a.attained && b.attained};
}

Interval bounds(double low, double high) { return limited(low, high, low == high); }

}  // namespace lab::language
