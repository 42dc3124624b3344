/// The figures of collective states.
#pragma once

#include <vector>

#include "analyzer/report/figures/figure_scripts.hpp"

namespace lab::report {

/// None below four robots.
[[nodiscard]] std::vector<FigureScript> crowdFigures(const RunRecord& record);

/// Two of them: the last frame, and the maps of density and current.
[[nodiscard]] FigureScript crowdArenaFigure(const RunRecord& record);
[[nodiscard]] FigureScript crowdMapFigure(const RunRecord& record);

}  // namespace lab::report
