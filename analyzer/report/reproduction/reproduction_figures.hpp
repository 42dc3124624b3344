/// Draws the panels of the paper's figures.
#pragma once

#include <vector>

#include "analyzer/report/figures/figure_scripts.hpp"
#include "analyzer/report/reproduction/reproduction_results.hpp"

namespace lab::report {

/// One script per panel ("fig2b"), in the width of a journal column, with its data as CSV. A panel
/// without data has a sentence in its place.
[[nodiscard]] std::vector<FigureScript> panelFigures(const std::vector<PaperPanel>& panels,
                                                     const Reproduction& reproduction);

}  // namespace lab::report
