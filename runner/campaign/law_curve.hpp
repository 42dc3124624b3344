/// A power law as a smooth curve over one swept key. Pure functions.
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "runner/campaign/campaign_table.hpp"
#include "runner/campaign/power_law.hpp"

namespace lab::runner::campaign {

/// The law that a figure shows.
struct DrawnLaw {
  PowerLaw law;
  std::vector<std::size_t> axes;  ///< whose keys it has, in the order of its exponents
  bool is_exact = false;  ///< that of the programmed parameters; otherwise fitted to the runs
};

/// The exact law if it is a power law; the fitted one if the quantity has no exact law and the
/// points agree with a power law (p >= 0.01).
[[nodiscard]] std::optional<DrawnLaw> drawnLaw(const CampaignData& data, const PooledTable& pooled,
                                               std::size_t quantity);

/// The law over the key of the axis `x`, from `low` to `high`, equally spaced on the axis as drawn.
/// @param values the other keys' values
/// @return pairs of the key and the quantity; empty if low = high
[[nodiscard]] std::vector<std::pair<double, double>> lawCurve(const DrawnLaw& law, std::size_t x,
                                                              const PointValues& values, double low,
                                                              double high, bool logarithmic);

}  // namespace lab::runner::campaign
