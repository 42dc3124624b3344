/// Numbers of the host as numbers of programs.
#pragma once

#include <algorithm>
#include <cmath>

#include "robot/dynamics/fixed_point.hpp"

namespace lab {

/// The nearest number of a program, limited to the largest one; 0 for nan.
[[nodiscard]] inline dynamics::Fixed fixedOf(double value) {
  if (std::isnan(value)) return 0;
  const double scaled = std::round(value * dynamics::kOne);
  return static_cast<dynamics::Fixed>(std::clamp(scaled, static_cast<double>(dynamics::kSmallest),
                                                 static_cast<double>(dynamics::kLargest)));
}

}  // namespace lab
