/// The figures of a campaign as gnuplot scripts: curves with intervals and theory, heat maps, small
/// multiples. Pure functions.
#pragma once

#include <cstddef>
#include <vector>

#include "analyzer/gnuplot_figures.hpp"
#include "runner/campaign/campaign_table.hpp"

namespace lab::runner::campaign {

/// How the swept keys share a figure.
struct Layout {
  std::size_t x = 0;                ///< axis along x
  std::vector<std::size_t> series;  ///< at most one axis, with a colour for each value
  std::vector<std::size_t> panels;  ///< the other axes: a panel for each combination
  bool scattered = false;  ///< a random design: one panel for each key, points without lines
};

/// The key with the most values runs along x; the one with the next most has colours.
[[nodiscard]] Layout layoutOf(const CampaignData& data);

/// The curves of one quantity, with the 95 % intervals of the points and the exact law.
[[nodiscard]] report::ScriptedFigure curveFigure(const CampaignData& data,
                                                 const PooledTable& pooled, std::size_t quantity);

/// Whether two numeric keys with three values each or more span a grid.
[[nodiscard]] bool hasMap(const CampaignData& data);

/// The quantity over two keys as colours, with numbers where there is room.
[[nodiscard]] report::ScriptedFigure mapFigure(const CampaignData& data, const PooledTable& pooled,
                                               std::size_t quantity);

/// The deviation from the exact law in standard errors, over two keys.
[[nodiscard]] report::ScriptedFigure deviationFigure(const CampaignData& data,
                                                     const PooledTable& pooled,
                                                     std::size_t quantity);

}  // namespace lab::runner::campaign
