/// Code words by which robots turn, so that a camera can tell them apart.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lab::runner {

/// In round i every robot turns on the spot: to the left if bit i of its word is set, to the right
/// otherwise.
struct TurningCode {
  int rounds = 0;
  std::vector<std::uint32_t> words;  ///< one per robot
};

/// A code with a word for each of `robots` robots (up to 2^20), in ceil(log2 N) rounds and at most
/// 6 more for a minimum distance of 4: one round that is seen wrongly is corrected, two are
/// detected.
///
/// Extended Hamming code (R. W. Hamming, Bell Syst. Tech. J. 29, 147, 1950), with every second bit
/// inverted. Words with fewer than kFewestReversals reversals are left out: a cap that keeps
/// turning in one direction could be anything.
[[nodiscard]] TurningCode turningCode(std::size_t robots);

inline constexpr int kFewestReversals = 3;

}  // namespace lab::runner
