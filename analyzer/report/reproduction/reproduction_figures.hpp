/// The panels of the paper's figures, drawn.
#pragma once

#include <vector>

#include "analyzer/report/figures/figure_scripts.hpp"
#include "analyzer/report/reproduction/reproduction_results.hpp"

namespace lab::report {

/// One script a panel ("fig2b"), a column of a journal wide, with what it draws as CSV. A panel
/// whose recordings hold nothing to draw has a sentence in its place.
[[nodiscard]] std::vector<FigureScript> panelFigures(const std::vector<PaperPanel>& panels,
                                                     const Reproduction& reproduction);

}  // namespace lab::report
