/// The figures of a run, drawn by gnuplot as SVG and PDF, with their data.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analyzer/report/record/run_record.hpp"

namespace lab::report {

/// One figure, or a sentence in its place if there is nothing to draw.
struct Figure {
  std::string name;  ///< of its files, without extension
  std::string title;
  std::string caption;   ///< explanation of the drawing
  std::string sentence;  ///< in place of the figure; empty: there is a figure
  std::string svg;       ///< the complete file, for the screen
  std::string pdf;       ///< the complete file, in the width of a journal
  std::string csv;       ///< the drawn data, with units in the header; empty: none
};

/// Draws every figure. The same record gives the same bytes.
/// @param scratch an existing folder for temporary files, which are removed.
/// @throws ReportError if gnuplot is missing.
[[nodiscard]] std::vector<Figure> drawFigures(const RunRecord& record,
                                              const std::filesystem::path& scratch);

}  // namespace lab::report
