#include "analyzer/report/html/html_verdicts.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>

#include "analyzer/report/figures/figure_scripts.hpp"
#include "analyzer/report/html/html_sections.hpp"
#include "analyzer/report/sections/fit_section.hpp"
#include "analyzer/report/sections/kurtosis_section.hpp"
#include "common/math/units.hpp"
#include "common/text/format.hpp"

namespace lab::report::html {
namespace {

using analysis::Estimate;
using analysis::ProgramResult;
using analysis::VerdictKind;

std::string withUnit(const std::string& number, const std::string& unit) {
  return unit.empty() || number == "–" ? number : number + " " + unit;
}

double halfInterval(const Estimate& estimate) {
  return (estimate.high95 - estimate.low95) / 2 * displayUnit(estimate.unit).factor;
}

std::string measuredText(const Estimate& estimate) {
  const DisplayUnit unit = displayUnit(estimate.unit);
  return withUnit(valueText(estimate.value * unit.factor, halfInterval(estimate)), unit.text);
}

std::string intervalText(const Estimate& estimate) {
  const double factor = displayUnit(estimate.unit).factor;
  const double half = halfInterval(estimate);
  if (!std::isfinite(half)) return "–";
  return fmt::format("{} to {}", valueText(estimate.low95 * factor, half),
                     valueText(estimate.high95 * factor, half));
}

const char* verdictWord(const ProgramResult& result) {
  const bool judged = result.law.known() && result.no_verdict.empty();
  return judged ? verdictClass(result.verdict.kind) : "no law";
}

/// The share of the time that is cut, for the table of verdicts; empty if it is small.
std::string notFree(const ProgramResult& result) {
  if (restriction(result).empty()) return {};
  return fmt::format("<span class=\"partly\">{:.0f} % not free;</span> ",
                     result.shares.cut() * units::kPercents);
}

std::string robotTable(const Finding& finding) {
  std::vector<std::string> columns{">robot", ">free motion", ">reversals", "verdict",
                                   ">largest deviation (standard errors)"};
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
        fmt::format("<span class=\"{}\">{}</span>", verdictClass(result), verdictWord(result)),
        decided ? fmt::format("{:.1f}", std::abs(result.verdict.max_z)) : "–"};
    for (const Estimate& estimate : result.estimates) {
      const double factor = displayUnit(estimate.unit).factor;
      const double half = halfInterval(estimate);
      const std::string value = valueText(estimate.value * factor, half);
      cells.push_back(std::isfinite(half) ? fmt::format("{} <span class=\"soft\">({})</span>",
                                                        value, intervalText(estimate))
                                          : value);
    }
    cells.resize(columns.size());
    table.row(cells);
  }
  return fmt::format("<details><summary>Results of each of the {}</summary>\n{}</details>\n",
                     countText(static_cast<std::int64_t>(finding.robots.size()), "robot"),
                     table.text());
}

std::string card(const Finding& finding) {
  const ProgramResult& result = finding.pool->result;
  const std::string pooled =
      result.robots > 1 ? fmt::format("{} together, ", countText(result.robots, "robot")) : "";
  const std::string limits = restriction(result);
  const std::string whole = wholeMotionText(result);
  const std::string free = freeMotionText(result);
  std::string html = fmt::format(
      "<section class=\"card\">\n<h3>{} <span class=\"soft\">· {} · {}</span></h3>\n"
      "{}<p class=\"verdict {}\">{}{}</p>\n<p>{} <span class=\"soft\">({}{} of free motion in {}.)"
      "</span></p>\n",
      escapeHtml(finding.name), escapeHtml(finding.model),
      escapeHtml(parametersText(*finding.pool)),
      limits.empty()
          ? ""
          : fmt::format("<p class=\"verdict partly\">{}.</p>\n<p>{}{}</p>\n", escapeHtml(limits),
                        whole.empty() ? "" : fmt::format("Whole motion: {}. ", whole),
                        free.empty() ? "" : fmt::format("Free motion: {}.", free)),
      verdictClass(result),
      static_cast<char>(std::toupper(static_cast<unsigned char>(verdictText(result).front()))),
      verdictText(result).substr(1), escapeHtml(verdictReason(result)), pooled,
      durationText(result.observed), countText(result.segments, "segment"));
  html += "<ul>\n";
  const std::string paper = paperComparison(result);
  if (!paper.empty()) html += fmt::format("<li>{}</li>\n", escapeHtml(paper));
  for (const std::string& remark : caveats(result)) {
    html += fmt::format("<li>{}</li>\n", escapeHtml(remark));
  }
  html += "</ul>\n" + estimateTable(result.estimates);
  if (result.fit) html += fitHtml(*result.fit);
  if (result.kurtosis) html += kurtosisHtml(*result.kurtosis);
  if (!finding.robots.empty()) html += robotTable(finding);
  return html + "</section>\n";
}

std::vector<std::string> verdictCells(const Finding& finding) {
  const ProgramResult& result = finding.pool->result;
  const analysis::Verdict& verdict = result.verdict;
  const bool decided = verdict.kind != VerdictKind::kUndecided;
  std::vector<std::string> cells{
      fmt::format("<span class=\"dot\" style=\"background:{}\"></span><b>{}</b>", finding.colour,
                  escapeHtml(finding.name)),
      fmt::format("<span class=\"soft\">{} · {}</span>", escapeHtml(finding.model),
                  escapeHtml(parametersText(*finding.pool))),
      fmt::format("{}<b class=\"{}\">{}</b>", notFree(result), verdictClass(result),
                  verdictWord(result)),
      decided ? fmt::format("{:.1f}", std::abs(verdict.max_z)) : "–",
      groupedText(verdict.judged),
      durationText(result.observed)};
  if (const Estimate* estimate = characteristicEstimate(result)) {
    const DisplayUnit unit = displayUnit(estimate->unit);
    cells.push_back(symbolHtml(estimate->name) + " = " + measuredText(*estimate));
    cells.push_back(intervalText(*estimate));
    cells.push_back(withUnit(shortText(estimate->theory * unit.factor), unit.text));
  } else {
    cells.insert(cells.end(), 3, "–");
  }
  return cells;
}

/// "the exact law or the simulated reference": what the programs are compared with.
std::string referencesText(const std::vector<Finding>& findings) {
  std::vector<std::string> references;
  for (const Finding& finding : findings) {
    const ProgramResult& result = finding.pool->result;
    if (!result.law.known() || !result.no_verdict.empty()) continue;
    const std::string reference = result.law->reference();
    if (std::ranges::find(references, reference) == references.end()) {
      references.push_back(reference);
    }
  }
  if (references.empty()) return "the law of the program";
  return fmt::format("{}", fmt::join(references, " or "));
}

}  // namespace

const char* verdictClass(const ProgramResult& result) {
  const bool agrees = result.verdict.kind == VerdictKind::kAgrees;
  return agrees && isRestricted(result) ? "partly" : verdictClass(result.verdict.kind);
}

const char* verdictClass(VerdictKind kind) {
  switch (kind) {
    case VerdictKind::kAgrees:
      return "agrees";
    case VerdictKind::kDisagrees:
      return "deviates";
    default:
      return "undecided";
  }
}

std::string estimateTable(const std::vector<Estimate>& estimates) {
  Table table({"", ">measured", ">95 % interval", ">programmed", "how"});
  for (const Estimate& estimate : estimates) {
    const DisplayUnit unit = displayUnit(estimate.unit);
    const double theory = estimate.theory;
    const bool outside = theory < estimate.low95 || theory > estimate.high95;
    table.row({symbolHtml(estimate.name), measuredText(estimate), intervalText(estimate),
               fmt::format("<span{}>{}</span>", outside ? " class=\"deviates\"" : "",
                           withUnit(shortText(theory * unit.factor), unit.text)),
               "<span class=\"soft\">" + escapeHtml(estimate.note) + "</span>"});
  }
  return table.text();
}

std::string verdictTable(const std::vector<Finding>& findings) {
  std::string html = "<h2>Is it the motion that was programmed?</h2>\n";
  if (findings.empty()) {
    return html +
           "<p>No robot was tracked while it ran a program of motion, "
           "so there is nothing to compare.</p>\n";
  }
  Table table({"program", "model", "verdict", ">largest deviation (standard errors)",
               ">judged lags", ">free motion", ">measured", ">95 % interval", ">programmed"});
  for (const Finding& finding : findings) table.row(verdictCells(finding));
  return html + table.text() +
         "<p class=\"soft\">The verdict compares the measured MSD and angular MSD with " +
         referencesText(findings) +
         ": the motion agrees if no judged lag deviates by 4 standard errors or more. By chance "
         "alone one run in a hundred exceeds 3.2. Only free motion is judged; what else the robots "
         "did is said first if it took more than a tenth of the time.</p>\n";
}

std::string programCards(const std::vector<Finding>& findings) {
  if (findings.empty()) return {};
  std::string html =
      "<h2>Program by program</h2>\n<p>Free motion is measured: reversals are removed; contacts "
      "and "
      "changes of program cut the track. A programmed value outside the 95 % interval of the "
      "measurement is coloured; by chance alone this happens to one value in twenty.</p>\n";
  for (const Finding& finding : findings) html += card(finding);
  return html;
}

}  // namespace lab::report::html
