/// The figures of a run, drawn by gnuplot as SVG.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "report/run_record.hpp"

namespace lab::report {

/// One figure, or the sentence that stands in its place when there is nothing to draw.
struct Figure {
  std::string name;  ///< of its file, without .svg
  std::string title;
  std::string caption;   ///< what is drawn how
  std::string sentence;  ///< in place of the figure; empty: there is one
  std::string svg;       ///< the whole file
};

/// Draws every figure. The same record gives the same bytes.
/// @param scratch an existing folder for gnuplot's files, which are gone afterwards.
/// @throws ReportError when gnuplot is missing.
[[nodiscard]] std::vector<Figure> drawFigures(const RunRecord& record,
                                              const std::filesystem::path& scratch);

}  // namespace lab::report
