/// Assigns big circles to small ones.
#pragma once

#include <cstddef>
#include <vector>

namespace lab::detector {

/// A big and a small circle that may belong to one cap.
struct CirclePair {
  int big = 0;  ///< index of the spot
  int small = 0;
  float cost = 0;  ///< [1] lower is better
  float rim = 0;   ///< [1] rim contrast around the cap
};

/// Greedy assignment: each circle is in at most one pair, cheapest pairs first; ties go to lower
/// indices. The other pairs are dropped.
/// @param pairs reordered
/// @return number of pairs chosen, which are the first ones
std::size_t choosePairs(std::vector<CirclePair>& pairs, int circles);

}  // namespace lab::detector
