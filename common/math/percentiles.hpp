/// Percentiles of delays.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "common/math/units.hpp"

namespace lab {

/// In the unit of the values; nan without values. By nearest rank, so each is one of the values.
struct Percentiles {
  std::size_t count = 0;
  double p50 = units::kNan;
  double p95 = p50;
  double p99 = p50;
  double max = p50;
};

[[nodiscard]] inline Percentiles percentilesOf(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto rank = [&values](double share) {
    const double place = std::ceil(share * static_cast<double>(values.size()));
    return values[static_cast<std::size_t>(std::max(1.0, place)) - 1];
  };
  return {values.size(), rank(0.50), rank(0.95), rank(0.99), values.back()};
}

}  // namespace lab
