/// The parts of report.html.
#pragma once

#include <string>
#include <vector>

#include "analyzer/report/figures/figures.hpp"
#include "analyzer/report/record/run_record.hpp"
#include "analyzer/report/summary/findings.hpp"

namespace lab::report::html {

/// What the reader must know before anything else: faults, marks, a run cut short. Empty: nothing.
[[nodiscard]] std::string warnings(const RunRecord& record);

/// The figures that open the page, by the names of their files; those that are missing are left
/// out.
[[nodiscard]] std::string openingFigures(const std::vector<Figure>& figures,
                                         const std::vector<std::string>& names);
/// All figures but those that open the page.
[[nodiscard]] std::string otherFigures(const std::vector<Figure>& figures,
                                       const std::vector<std::string>& opening);
[[nodiscard]] std::string lightSteps(const RunRecord& record);
[[nodiscard]] std::string robots(const RunRecord& record);
[[nodiscard]] std::string losses(const RunRecord& record);
/// Empty where all services ran on one host.
[[nodiscard]] std::string links(const RunRecord& record);
[[nodiscard]] std::string provenance(const RunRecord& record);
/// In place of the last two, of a run that has no log.
[[nodiscard]] std::string poseSource(const RunRecord& record);

/// A table; cells are HTML already.
class Table {
 public:
  /// A column whose name begins with '>' is aligned to the right, as numbers are.
  explicit Table(const std::vector<std::string>& columns);
  void row(const std::vector<std::string>& cells);
  [[nodiscard]] std::string text() const { return text_ + "</tbody></table></div>\n"; }

 private:
  std::vector<bool> right_;
  std::string text_;
};

}  // namespace lab::report::html
