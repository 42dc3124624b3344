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

/// Measured values, their intervals, what was programmed, and how.
[[nodiscard]] std::string estimateTable(const std::vector<analysis::Estimate>& estimates);
[[nodiscard]] std::string verdicts(const std::vector<Finding>& findings);
[[nodiscard]] std::string figureSection(const std::vector<Figure>& figures);
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
