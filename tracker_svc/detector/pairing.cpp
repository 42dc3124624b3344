#include "tracker_svc/detector/pairing.hpp"

#include <algorithm>
#include <cstddef>
#include <tuple>

namespace lab::detector {

std::size_t choosePairs(std::vector<CirclePair>& pairs, int circles) {
  std::sort(pairs.begin(), pairs.end(), [](const CirclePair& a, const CirclePair& b) {
    return std::tie(a.cost, a.big, a.small) < std::tie(b.cost, b.big, b.small);
  });
  std::vector<bool> taken(static_cast<std::size_t>(circles), false);
  const auto end = std::stable_partition(pairs.begin(), pairs.end(), [&](const CirclePair& c) {
    const auto big = static_cast<std::size_t>(c.big);
    const auto small = static_cast<std::size_t>(c.small);
    if (taken[big] || taken[small]) return false;
    taken[big] = true;
    taken[small] = true;
    return true;
  });
  return static_cast<std::size_t>(end - pairs.begin());
}

}  // namespace lab::detector
