/// What the figures of a campaign share: the values of the axes, the panels, the ranges.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "runner/campaign/campaign_figures.hpp"
#include "runner/campaign/campaign_table.hpp"

namespace lab::runner::campaign {

inline constexpr std::size_t kMostPanels = 12;

/// The values of an axis that occur, in the order of the axis, or of their size.
std::vector<std::string> valuesOf(const CampaignData& data, std::size_t axis);

/// "v (cm/s)".
std::string axisText(const Axis& axis);

/// "v = 5 cm/s".
std::string valueWithUnit(const Axis& axis, const std::string& value);

/// A number for gnuplot.
std::string numberText(double value);

/// Values at some axes: what the points of a panel or series have in common.
using Fixed = std::vector<std::pair<std::size_t, std::string>>;

/// Whether a point has these values.
bool matches(const Point& point, const Fixed& fixed);

/// All combinations of the values of some axes that occur.
std::vector<Fixed> combinationsOf(const CampaignData& data, const std::vector<std::size_t>& axes);

/// "v = 5 cm/s, eta = 1 rad/s".
std::string fixedText(const CampaignData& data, const Fixed& fixed);

/// The figure with its preamble, for panels.
std::string figureHead(const std::string& name, std::size_t panels);

/// The range of some numbers.
struct Extent {
  static constexpr double kLogRatio = 12;  ///< of values, from which an axis is logarithmic
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void add(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  [[nodiscard]] bool isLogarithmic() const { return low > 0 && high / low >= kLogRatio; }
  [[nodiscard]] bool empty() const { return !(low <= high); }
  /// Where a value lies between low (0) and high (1), on the axis as it is drawn.
  [[nodiscard]] double shareOf(double value) const {
    return isLogarithmic() ? std::log(value / low) / std::log(high / low)
                           : (value - low) / (high - low);
  }
};

}  // namespace lab::runner::campaign
