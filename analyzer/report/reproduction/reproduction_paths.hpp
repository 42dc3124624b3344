/// Panels that show a single recording (its path, its speed), and what all panels share.
#pragma once

#include "analyzer/laws/paper_figures.hpp"
#include "analyzer/report/figures/figure_scripts.hpp"
#include "analyzer/report/reproduction/reproduction_data.hpp"

namespace lab::report::panels {

/// Size of every panel [px].
inline constexpr int kWidth = 480;
inline constexpr int kHeight = 460;

[[nodiscard]] FigureScript trajectory(const PaperPanel& panel, const SetData& set);
[[nodiscard]] FigureScript runsAndTumbles(const PaperPanel& panel, const SetData& set);

}  // namespace lab::report::panels
