#include "analyzer/report/html/report_page.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <string_view>

#include "analyzer/report/html/html_sections.hpp"
#include "analyzer/report/html/html_style.hpp"
#include "analyzer/report/html/html_verdicts.hpp"
#include "analyzer/report/sections/crowd_section.hpp"
#include "analyzer/report/sections/light_bands.hpp"
#include "analyzer/report/sections/run_section.hpp"
#include "analyzer/report/sections/segments.hpp"
#include "analyzer/report/summary/findings.hpp"
#include "common/text/format.hpp"

namespace lab::report {
namespace {

std::string lead(const RunRecord& record) {
  std::vector<std::string> parts;
  parts.push_back(countText(static_cast<std::int64_t>(record.robots.size()), "robot"));
  parts.push_back(durationText(record.duration()));
  if (record.frame_period > 0) {
    parts.push_back(fmt::format("{} frames a second", shortText(1 / record.frame_period)));
  }
  if (record.experiment && !record.poses)
    parts.push_back(fmt::format("seed {}", record.experiment->seed));
  if (record.poses) {
    parts.emplace_back("from poses alone");
    return fmt::format("{}", fmt::join(parts, " · "));
  }
  parts.push_back(record.log.virtual_time ? "virtual time" : utcText(record.start_utime));
  return fmt::format("{}", fmt::join(parts, " · "));
}

/// The section as a part that opens by a click on its heading. A section begins with its heading,
/// or is empty.
std::string folded(const std::string& section) {
  constexpr std::string_view kEnd = "</h2>\n";
  const std::size_t end = section.find(kEnd);
  if (end == std::string::npos) return section;
  return fmt::format("<details class=\"part\"><summary>{}</summary>\n{}</details>\n",
                     section.substr(0, end + kEnd.size() - 1), section.substr(end + kEnd.size()));
}

/// Names of the opening figures: trajectories, MSD with the exact law, and light with programs.
std::vector<std::string> openingNames(const std::vector<Finding>& findings) {
  const std::string msd = findings.size() == 1 ? "msd_" + findings.front().file : "msd";
  return {"trajectory_program", msd, "light"};
}

}  // namespace

std::string reportHtml(const RunRecord& record, const std::vector<Figure>& figures) {
  const std::string name =
      escapeHtml(record.experiment ? record.experiment->name : "Log without an experiment");
  const std::string description = record.experiment ? record.experiment->description : "";
  const std::vector<Finding> findings = findingsOf(record);
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<h1>{0}</h1>\n"
      "<p class=\"lead\">{2}</p>\n{3}",
      name, html::kStyle, escapeHtml(lead(record)),
      description.empty() ? "" : fmt::format("<p>{}</p>\n", escapeHtml(description)));
  const std::vector<std::string> opening = openingNames(findings);
  page += html::warnings(record);
  page += html::openingFigures(figures, opening);
  page += html::verdictTable(findings);
  page += folded(html::programCards(findings));
  page += folded(html::runs(findings, record.experimentOrDefault().hardware.max_wheel_speed));
  page += folded(html::crowds(record, figures));
  std::vector<std::string> shown = opening;
  for (const std::string& figure : crowdFigureNames()) shown.push_back(figure);
  page += folded(html::otherFigures(figures, shown));
  page += folded(html::stitching(record));
  if (record.poses) {
    page += folded(html::poseSource(record));
    return page + "</body>\n</html>\n";
  }
  page += folded(html::film(record));
  page += folded(html::lightSteps(record));
  page += folded(html::virtualSenses(record));
  page += folded(html::lightBands(record));
  page += folded(html::robots(record));
  page += folded(html::losses(record));
  page += folded(html::serialLines(record));
  page += folded(html::links(record));
  page += folded(html::provenance(record));
  return page + "</body>\n</html>\n";
}

}  // namespace lab::report
