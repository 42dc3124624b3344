#include "analyzer/report/figures/figures.hpp"

#include <utility>

#include "analyzer/report/figures/figure_crowd.hpp"
#include "analyzer/report/figures/figure_files.hpp"
#include "analyzer/report/figures/figure_scripts.hpp"

namespace lab::report {
namespace fs = std::filesystem;

std::vector<Figure> drawFigures(const RunRecord& record, const fs::path& scratch) {
  std::vector<FigureScript> scripts{trajectoryByTime(record), trajectoryByProgram(record)};
  if (!record.poses) scripts.push_back(lightAndPrograms(record));
  scripts.push_back(speedTraces(record));
  const std::vector<Finding> findings = findingsOf(record);
  if (findings.size() > 1) scripts.push_back(msdOverview(findings));
  for (const Finding& finding : findings) {
    scripts.push_back(msdFigure(finding));
    scripts.push_back(angularMsdFigure(finding));
    const auto& runs = finding.pool->result.runs;
    if (runs && runs->problem.empty()) {
      scripts.push_back(runTimesFigure(finding));
      scripts.push_back(turnsFigure(finding));
    }
  }
  for (FigureScript& script : crowdFigures(record)) scripts.push_back(std::move(script));
  return drawScripts(std::move(scripts), scratch);
}

}  // namespace lab::report
