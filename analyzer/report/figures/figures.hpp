/// The figures of a run, drawn by gnuplot: for the screen as SVG, for paper as PDF, with their
/// data.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analyzer/report/record/run_record.hpp"

namespace lab::report {

/// One figure, or the sentence that stands in its place when there is nothing to draw.
struct Figure {
  std::string name;  ///< of its files, without their endings
  std::string title;
  std::string caption;   ///< what is drawn how
  std::string sentence;  ///< in place of the figure; empty: there is one
  std::string svg;       ///< the whole file, for the screen
  std::string pdf;       ///< the whole file, as wide as a journal prints it
  std::string csv;       ///< what is drawn, a header with units first; empty: not given
};

/// Draws every figure. The same record gives the same bytes.
/// @param scratch an existing folder for gnuplot's files, which are gone afterwards.
/// @throws ReportError when gnuplot is missing.
[[nodiscard]] std::vector<Figure> drawFigures(const RunRecord& record,
                                              const std::filesystem::path& scratch);

}  // namespace lab::report
