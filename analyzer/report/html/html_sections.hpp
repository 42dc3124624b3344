/// The sections of report.html. Each begins with its heading.
#pragma once

#include <string>
#include <vector>

#include "analyzer/report/figures/figures.hpp"
#include "analyzer/report/record/run_record.hpp"
#include "analyzer/report/summary/findings.hpp"

namespace lab::report::html {

/// Faults, marks and other warnings at the top of the page; empty if there are none.
[[nodiscard]] std::string warnings(const RunRecord& record);

/// The figures that open the page, by the names of their files; those that are missing are left
/// out.
[[nodiscard]] std::string openingFigures(const std::vector<Figure>& figures,
                                         const std::vector<std::string>& names);
/// Figures in columns, by the names of their files; those that are missing are left out.
[[nodiscard]] std::string figureGrid(const std::vector<Figure>& figures,
                                     const std::vector<std::string>& names);
/// All figures but those that open the page.
[[nodiscard]] std::string otherFigures(const std::vector<Figure>& figures,
                                       const std::vector<std::string>& opening);
/// Empty without a film.
[[nodiscard]] std::string film(const RunRecord& record);
[[nodiscard]] std::string lightSteps(const RunRecord& record);
/// Empty without virtual senses.
[[nodiscard]] std::string virtualSenses(const RunRecord& record);
[[nodiscard]] std::string serialLines(const RunRecord& record);
[[nodiscard]] std::string robots(const RunRecord& record);
[[nodiscard]] std::string losses(const RunRecord& record);
/// Empty if all services ran on one host.
[[nodiscard]] std::string links(const RunRecord& record);
[[nodiscard]] std::string provenance(const RunRecord& record);
/// In place of losses() and provenance() for a run from a file of poses.
[[nodiscard]] std::string poseSource(const RunRecord& record);

/// A table. Cells are HTML.
class Table {
 public:
  /// Columns whose name begins with '>' are aligned to the right.
  explicit Table(const std::vector<std::string>& columns);
  void row(const std::vector<std::string>& cells);
  [[nodiscard]] std::string text() const { return text_ + "</tbody></table></div>\n"; }

 private:
  std::vector<bool> right_;
  std::string text_;
};

}  // namespace lab::report::html
