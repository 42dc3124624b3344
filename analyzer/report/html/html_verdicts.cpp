#include <fmt/format.h>

#include <cctype>
#include <cmath>

#include "analyzer/report/html/html_sections.hpp"
#include "analyzer/report/sections/brownian_section.hpp"
#include "analyzer/report/sections/fit_section.hpp"
#include "common/text/format.hpp"

namespace lab::report::html {
namespace {

using analysis::Estimate;
using analysis::ProgramResult;
using analysis::VerdictKind;

const char* verdictClass(VerdictKind kind) {
  switch (kind) {
    case VerdictKind::kAgrees:
      return "agrees";
    case VerdictKind::kDisagrees:
      return "disagrees";
    default:
      return "undecided";
  }
}

std::string withUnit(const std::string& number, const std::string& unit) {
  return unit.empty() || number == "–" ? number : number + " " + unit;
}

std::string robotTable(const Finding& finding) {
  std::vector<std::string> columns{">robot", ">free motion", ">reversals", "verdict",
                                   ">largest deviation"};
  for (const Estimate& estimate : finding.pool->result.estimates) {
    const DisplayUnit unit = displayUnit(estimate.unit);
    columns.push_back(">" + symbolHtml(estimate.name) +
                      (unit.text.empty() ? "" : " (" + unit.text + ")"));
  }
  Table table(columns);
  for (const analysis::FeedResult* robot : finding.robots) {
    const ProgramResult& result = robot->result;
    const bool decided = result.verdict.kind != VerdictKind::kUndecided;
    std::vector<std::string> cells{
        std::to_string(result.robot), durationText(result.observed),
        std::to_string(result.reversals),
        fmt::format("<span class=\"{}\">{}</span>", verdictClass(result.verdict.kind),
                    decided ? verdictClass(result.verdict.kind) : "undecided"),
        decided ? fmt::format("{:.1f} σ", std::abs(result.verdict.max_z)) : "–"};
    for (const Estimate& estimate : result.estimates) {
      const double factor = displayUnit(estimate.unit).factor;
      const double half = (estimate.high95 - estimate.low95) / 2 * factor;
      const std::string value = valueText(estimate.value * factor, half);
      cells.push_back(std::isfinite(half)
                          ? fmt::format("{} <span class=\"soft\">({} to {})</span>", value,
                                        valueText(estimate.low95 * factor, half),
                                        valueText(estimate.high95 * factor, half))
                          : value);
    }
    cells.resize(columns.size());
    table.row(cells);
  }
  return fmt::format("<details><summary>Each of the {}</summary>\n{}</details>\n",
                     countText(static_cast<std::int64_t>(finding.robots.size()), "robot"),
                     table.text());
}

std::string card(const Finding& finding) {
  const ProgramResult& result = finding.pool->result;
  const std::string pooled =
      result.robots > 1 ? fmt::format("{} together, ", countText(result.robots, "robot")) : "";
  std::string html = fmt::format(
      "<section class=\"card\">\n<h3>{} <span class=\"soft\">· {} · {}</span></h3>\n"
      "<p class=\"verdict {}\">{}{}</p>\n<p>{} <span class=\"soft\">({}{} of free motion in {}.)"
      "</span></p>\n",
      escapeHtml(finding.name), escapeHtml(finding.model),
      escapeHtml(parametersText(finding.pool->program)), verdictClass(result.verdict.kind),
      static_cast<char>(std::toupper(static_cast<unsigned char>(verdictText(result).front()))),
      verdictText(result).substr(1), escapeHtml(verdictReason(result)), pooled,
      durationText(result.observed), countText(result.segments, "segment"));
  html += "<ul>\n";
  const std::string paper = paperComparison(result);
  if (!paper.empty()) html += fmt::format("<li>{}</li>\n", escapeHtml(paper));
  for (const std::string& remark : reservations(result)) {
    html += fmt::format("<li>{}</li>\n", escapeHtml(remark));
  }
  html += "</ul>\n" + estimateTable(result.estimates);
  if (result.fit) html += fitHtml(*result.fit);
  if (result.brownian) html += brownianHtml(*result.brownian);
  if (!finding.robots.empty()) html += robotTable(finding);
  return html + "</section>\n";
}

}  // namespace

std::string estimateTable(const std::vector<Estimate>& estimates) {
  Table table({"", ">measured", ">95 % interval", ">programmed", "how"});
  for (const Estimate& estimate : estimates) {
    const DisplayUnit unit = displayUnit(estimate.unit);
    const double half = (estimate.high95 - estimate.low95) / 2 * unit.factor;
    const std::string interval =
        std::isfinite(half) ? fmt::format("{} to {}", valueText(estimate.low95 * unit.factor, half),
                                          valueText(estimate.high95 * unit.factor, half))
                            : "–";
    const double theory = estimate.theory;
    const bool outside = theory < estimate.low95 || theory > estimate.high95;
    table.row({symbolHtml(estimate.name),
               withUnit(valueText(estimate.value * unit.factor, half), unit.text), interval,
               fmt::format("<span{}>{}</span>", outside ? " class=\"disagrees\"" : "",
                           withUnit(shortText(theory * unit.factor), unit.text)),
               "<span class=\"soft\">" + escapeHtml(estimate.note) + "</span>"});
  }
  return table.text();
}

std::string verdicts(const std::vector<Finding>& findings) {
  std::string html =
      "<h2>Is it the motion that was programmed?</h2>\n<p>Measured is free motion: reversals are "
      "taken out, contacts and changes of program cut. Programmed values outside their 95 % "
      "interval "
      "are set in colour; by chance one of twenty is.</p>\n";
  if (findings.empty()) {
    return html +
           "<p>No robot was tracked while it ran a program that has a law, so there is nothing to "
           "compare.</p>\n";
  }
  for (const Finding& finding : findings) html += card(finding);
  return html;
}

}  // namespace lab::report::html
