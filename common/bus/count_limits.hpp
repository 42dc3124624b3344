/// The largest counts that a message may carry. Sums over the lists of a message, and over a log,
/// do not overflow.
#pragma once

#include <cstdint>

namespace lab {

inline constexpr std::int64_t kMostCounted = std::int64_t{1} << 50;
inline constexpr std::int64_t kMostOnLink = std::int64_t{1} << 40;  ///< packets

}  // namespace lab
