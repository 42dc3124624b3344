/// The panels of the paper's figures, drawn.
#pragma once

#include <vector>

#include "analyzer/report/figures/figure_scripts.hpp"
#include "analyzer/report/reproduction/reproduction_results.hpp"

namespace lab::report {

/// One script a panel ("fig2b"), a column of a journal wide, with what it draws as CSV. A panel
/// whose films hold nothing to draw has a sentence in its place.
[[nodiscard]] std::vector<FigureScript> panelFigures(const std::vector<PaperPanel>& panels,
                                                     const Reproduction& reproduction);

namespace panels {

/// Size of every panel [px].
inline constexpr int kWidth = 480;
inline constexpr int kHeight = 460;

/// One series of a panel: colour and symbol tell it apart, each by itself.
struct SeriesStyle {
  std::string_view colour;
  int symbol;       ///< gnuplot's, filled
  int open_symbol;  ///< the same, hollow
};
[[nodiscard]] SeriesStyle look(std::size_t series, std::size_t of);

[[nodiscard]] FigureScript trajectory(const PaperPanel& panel, const SetData& set);
[[nodiscard]] FigureScript runsAndTumbles(const PaperPanel& panel, const SetData& set);

}  // namespace panels
}  // namespace lab::report
