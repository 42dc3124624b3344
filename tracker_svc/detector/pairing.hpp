/// Which big circle belongs to which small one.
#pragma once

#include <cstddef>
#include <vector>

namespace lab::detector {

/// A big and a small circle that could be one cap's.
struct CirclePair {
  int big = 0;  ///< index of the circle
  int small = 0;
  float cost = 0;  ///< [1] the less the better
  float rim = 0;   ///< [1] contrast around the cap that they would make
};

/// The couples that can all be true: each circle in one couple at most, the cheapest couples first;
/// for equal cost the one with the lower numbers. What does not fit is left out.
/// @param couples sorted by this
/// @return how many of the first couples were taken
std::size_t choosePairs(std::vector<CirclePair>& couples, int circles);

}  // namespace lab::detector
