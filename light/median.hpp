/// The median, for every component.
#pragma once

#include <algorithm>
#include <iterator>

namespace lab {

/// The upper median: element n / 2 of the n sorted values, counted from 0.
/// @param values at least one; they are reordered
template <class Values>
[[nodiscard]] auto medianOf(Values&& values) {
  const auto middle = std::begin(values) + std::ssize(values) / 2;
  std::nth_element(std::begin(values), middle, std::end(values));
  return *middle;
}

}  // namespace lab
