#include "runner/campaign/campaign_page.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

#include "analyzer/analyze_run.hpp"
#include "analyzer/gnuplot_figures.hpp"
#include "common/files/atomic_file.hpp"
#include "common/files/file_text.hpp"
#include "common/files/scratch_folder.hpp"
#include "common/process/installation.hpp"
#include "common/text/format.hpp"
#include "runner/campaign/adaptive/adaptive_page.hpp"
#include "runner/campaign/adaptive/adaptive_rounds.hpp"
#include "runner/campaign/campaign_figures.hpp"
#include "runner/campaign/campaign_laws.hpp"
#include "runner/campaign/live/live_engine.hpp"
#include "runner/campaign/live/live_journal.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner::campaign {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMostFigures = 6;
constexpr std::size_t kMostColumns = 6;  // quantities in the table of points
constexpr std::size_t kMostRuns = 2000;  // rows in the table of runs
constexpr std::size_t kMostListed = 20;  // failures

constexpr const char* kMoreStyle = R"css(
body { max-width: 80rem; }
.figures { grid-template-columns: repeat(auto-fit, minmax(30rem, 1fr)); }
.wide { grid-column: 1 / -1; }
)css";

std::string requestSentence(const CampaignData& data) {
  std::vector<std::string> keys;
  for (const Axis& axis : data.axes) keys.push_back(axis.key);
  std::string text = countText(static_cast<std::int64_t>(data.points.size()), "point");
  if (!keys.empty()) text += fmt::format(" in {}", fmt::join(keys, ", "));
  text += " · " + (data.request.adaptive ? chosenText(data)
                                         : countText(data.request.seeds, "run") + " each");
  if (data.request.random > 0) {
    text += data.request.sampling == Sampling::kSobol ? " · drawn by Sobol's sequence"
                                                      : " · drawn by a Latin hypercube";
  }
  return text + " · " + data.code.text;
}

/// Figures of earlier pages, which showed other quantities or fewer runs, are removed.
void writeFigures(const fs::path& folder, const std::vector<report::DrawnFigure>& figures) {
  fs::create_directories(folder);
  std::set<fs::path> written;
  for (const report::DrawnFigure& figure : figures) {
    written.insert(folder / (figure.name + ".svg"));
    replaceFile(folder / (figure.name + ".svg"), figure.svg);
    written.insert(folder / (figure.name + ".pdf"));
    replaceFile(folder / (figure.name + ".pdf"), figure.pdf);
  }
  for (const fs::directory_entry& file : fs::directory_iterator(folder)) {
    const fs::path kind = file.path().extension();
    if ((kind == ".svg" || kind == ".pdf") && !written.contains(file.path())) {
      fs::remove(file.path());
    }
  }
}

/// What a reader must know before the figures, a sentence each.
std::vector<std::string> warningsOf(const CampaignData& data, const PooledTable& pooled) {
  using enum RowState::Kind;
  std::vector<std::string> warnings;
  const auto count = [&](RowState::Kind kind) {
    return static_cast<std::int64_t>(data.survey.count(kind));
  };
  const auto all = static_cast<std::int64_t>(data.rows.size());
  if (count(kMissing) + count(kDamaged) > 0 && !data.request.adaptive) {
    warnings.push_back(
        fmt::format("{} of {} runs have no result yet.", count(kMissing) + count(kDamaged), all));
  }
  if (count(kFailed) > 0) {
    warnings.push_back(
        fmt::format("{} of {} runs failed; they are listed below.", count(kFailed), all));
  }
  if (count(kStale) > 0) {
    warnings.push_back(
        fmt::format("{} of {} results are stale: another version of the lab computed them.",
                    count(kStale), all));
  }
  int faults = 0;
  for (const PooledPoint& point : pooled.points) faults += point.faults;
  if (faults > 0) warnings.push_back(fmt::format("{} have faults.", countText(faults, "run")));
  if (data.request.common_seeds) {
    warnings.emplace_back(
        "All points share their random numbers (--common-seeds). Differences between points are "
        "known better than the intervals say; the errors of the points are correlated, so that a "
        "whole curve may lie above or below the law.");
  }
  return warnings;
}

std::string numberWithError(const PooledNumber& number) {
  if (!std::isfinite(number.mean)) return "–";
  if (!std::isfinite(number.sigma)) return shortText(number.mean);
  return fmt::format("{} ± {}", valueText(number.mean, number.sigma),
                     valueText(number.sigma, number.sigma));
}

std::string fittedText(const FittedNumber& number) {
  return fmt::format("{} (95 %: {} to {})", valueText(number.value, number.sigma),
                     valueText(number.low95, number.sigma), valueText(number.high95, number.sigma));
}

/// "D_r of NAME = C epsilon^a eta^b: C = ..., a = ..., b = ..."
std::optional<std::string> powerLawSentence(const CampaignData& data, const PooledTable& pooled,
                                            std::size_t quantity) {
  const auto law = powerLawOf(data, pooled, quantity);
  if (!law) return {};
  const QuantityLabel label = labelOf(pooled.quantities[quantity].name);
  std::string form = letterOf(label.symbol) + " of " + label.program + " = C";
  std::string exponents;
  for (std::size_t k = 0; k < law->axes.size(); ++k) {
    const std::string symbol = letterOf(data.axes[law->axes[k]].symbol());
    const std::string letter(1, static_cast<char>('a' + k));
    form += " " + symbol + "^" + letter;
    exponents += fmt::format(", {} = {}", letter, fittedText(law->measured.exponents[k]));
    if (law->exact) {
      exponents += fmt::format(", law {}", shortText(law->exact->exponents[k].value));
    }
  }
  std::string text = fmt::format("{}: C = {}", form, fittedText(law->measured.prefactor));
  if (law->exact) text += fmt::format(", law {}", shortText(law->exact->prefactor.value));
  text += exponents;
  if (std::isfinite(law->measured.p)) {
    text += fmt::format("; the power law describes the points with p = {:.2g}", law->measured.p);
  }
  return text;
}

std::optional<std::string> agreementSentence(const CampaignData& data, const PooledTable& pooled,
                                             std::size_t quantity) {
  const LawAgreement agreement = agreementOf(pooled, quantity);
  if (agreement.points == 0) return {};
  std::string text = fmt::format("{}: {} of {} intervals hold the exact law",
                                 labelOf(pooled.quantities[quantity].name).text(), agreement.held,
                                 agreement.points);
  if (!data.request.common_seeds) {
    text += fmt::format(", largest deviation {:.1f} standard errors, all together p = {:.2g}",
                        agreement.largest, agreement.p);
  }
  return text;
}

std::string linkTo(const CampaignData& data, std::size_t row, const fs::path& folder) {
  const RunIdentity& run = data.rows[row].identity;
  std::error_code error;
  std::string links;
  const auto add = [&](const fs::path& file, const char* text) {
    if (!fs::exists(folder / file, error)) return;
    links += fmt::format("{}<a href=\"{}\">{}</a>", links.empty() ? "" : " ", file.string(), text);
  };
  add(runFolder(run) / "report.html", "report");
  add(summaryFile(run), "summary");
  add(resultFile(run), "numbers");
  return links;
}

std::string pointsTable(const CampaignData& data, const PooledTable& pooled,
                        const std::vector<std::size_t>& leading) {
  std::string html = "<div class=\"scroll\"><table><tr>";
  for (const Axis& axis : data.axes) {
    html += fmt::format("<th>{}</th>",
                        escapeHtml(letterOf(axis.symbol()) +
                                   (axis.unit().empty() ? "" : " (" + axis.unit() + ")")));
  }
  html += "<th class=\"r\">runs</th>";
  const std::size_t columns = std::min(leading.size(), kMostColumns);
  for (std::size_t i = 0; i < columns; ++i) {
    const Quantity& quantity = pooled.quantities[leading[i]];
    html += fmt::format("<th class=\"r\">{}</th>", escapeHtml(labelOf(quantity.name).text()));
    if (quantity.has_theory) html += "<th class=\"r\">law</th>";
  }
  html += "<th>verdicts</th></tr>\n";
  for (std::size_t p = 0; p < data.points.size(); ++p) {
    const PooledPoint& point = pooled.points[p];
    html += "<tr>";
    for (const std::string& value : data.points[p].values) {
      html += fmt::format("<td>{}</td>", escapeHtml(value));
    }
    html += fmt::format("<td class=\"r\">{}</td>", point.runs);
    for (std::size_t i = 0; i < columns; ++i) {
      html += fmt::format("<td class=\"r\">{}</td>", numberWithError(point.numbers[leading[i]]));
      if (pooled.quantities[leading[i]].has_theory) {
        html += fmt::format("<td class=\"r\">{}</td>", shortText(point.theory[leading[i]]));
      }
    }
    std::string verdicts;
    for (const auto& [name, counts] : point.verdicts) {
      for (const auto& [verdict, count] : counts) {
        verdicts += fmt::format("{}{} {}", verdicts.empty() ? "" : ", ", count,
                                verdict == "disagrees" ? "deviates" : verdict);
      }
    }
    html += fmt::format("<td>{}</td></tr>\n", escapeHtml(verdicts));
  }
  return html + "</table></div>\n";
}

std::string runsTable(const CampaignData& data, const fs::path& folder) {
  std::string html =
      "<details class=\"part\"><summary><h2>Runs</h2></summary>\n<div class=\"scroll\"><table><tr>"
      "<th class=\"r\">row</th>";
  for (const Axis& axis : data.axes)
    html += fmt::format("<th>{}</th>", escapeHtml(letterOf(axis.symbol())));
  html += "<th>seed</th><th>run</th><th>status</th><th>files</th></tr>\n";
  const std::size_t shown = std::min(kMostRuns, data.rows.size());
  for (std::size_t i = 0; i < shown; ++i) {
    const Row& row = data.rows[i];
    html += fmt::format("<tr><td class=\"r\">{}</td>", i);
    for (const std::string& value : data.points[row.point].values) {
      html += fmt::format("<td>{}</td>", escapeHtml(value));
    }
    std::string status = statusText(data.survey.rows[i].kind);
    if (!data.survey.rows[i].note.empty()) status += ": " + data.survey.rows[i].note;
    html += fmt::format("<td>{}</td><td><code>{}</code></td><td>{}</td><td>{}</td></tr>\n",
                        row.seed, row.identity.text(), escapeHtml(status), linkTo(data, i, folder));
  }
  html += "</table></div>\n";
  if (shown < data.rows.size()) {
    html += fmt::format("<p class=\"soft\">The first {} of {} runs; campaign.csv has all.</p>\n",
                        shown, data.rows.size());
  }
  return html + "</details>\n";
}

std::string failuresList(const CampaignData& data) {
  std::string items;
  std::size_t failed = 0;
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    const RowState& state = data.survey.rows[i];
    if (state.kind != RowState::Kind::kFailed && state.kind != RowState::Kind::kDamaged) continue;
    if (++failed > kMostListed) continue;
    items += fmt::format(
        "<li>row {} ({}): {}: {}</li>\n", i,
        escapeHtml(fmt::format("{}", fmt::join(data.points[data.rows[i].point].values, ", "))),
        statusText(state.kind), escapeHtml(state.note));
  }
  if (failed == 0) return {};
  if (failed > kMostListed) {
    items += fmt::format("<li>and {} more, in campaign.json</li>\n", failed - kMostListed);
  }
  return "<h2>Failures</h2>\n<ul>" + items + "</ul>\n";
}

/// How the time of a live campaign was spent, and which robots misbehaved.
std::string liveSection(const fs::path& folder) {
  const std::vector<JournalEntry> entries = readJournal(journalText(folder)).entries;
  std::map<std::int32_t, std::map<std::string, int>> robots;
  for (const JournalEntry& entry : entries) {
    for (const auto& [id, problem] : entry.robots) {
      if (!problem.empty()) ++robots[id][problem];
    }
  }
  std::string html =
      fmt::format("<h2>On the lab</h2>\n<p>{}</p>\n", escapeHtml(accountText(accountOf(entries))));
  if (robots.empty()) return html;
  html += "<ul>";
  for (const auto& [id, problems] : robots) {
    std::string text;
    for (const auto& [problem, count] : problems) {
      text += fmt::format("{}{} in {}", text.empty() ? "" : ", ", problem, countText(count, "run"));
    }
    html += fmt::format("<li>robot {}: {}</li>\n", id, escapeHtml(text));
  }
  return html + "</ul>\n";
}

std::string figureHtml(const report::DrawnFigure& figure) {
  constexpr int kWide = 900;  // [px]
  const std::size_t width = figure.svg.find("width=\"");
  const bool wide = width != std::string::npos && std::atoi(figure.svg.c_str() + width + 7) > kWide;
  return fmt::format(
      "<figure{}>{}<figcaption><b>{}.</b> {} <a href=\"{}/{}.pdf\">PDF</a></figcaption></figure>\n",
      wide ? " class=\"wide\"" : "", report::svgElement(figure.svg, figure.name + "_"),
      escapeHtml(figure.title), escapeHtml(figure.caption), names::kFigures, figure.name);
}

std::vector<report::ScriptedFigure> scriptsOf(const CampaignData& data, const PooledTable& pooled,
                                              const std::vector<std::size_t>& leading) {
  std::vector<report::ScriptedFigure> scripts;
  const bool any =
      std::ranges::any_of(pooled.points, [](const PooledPoint& p) { return p.runs > 0; });
  if (data.axes.empty() || !any) return scripts;
  for (std::size_t i = 0; i < leading.size(); ++i) {
    scripts.push_back(curveFigure(data, pooled, leading[i]));
    if (i > 0 || !hasMap(data)) continue;
    scripts.push_back(mapFigure(data, pooled, leading[i]));
    if (pooled.quantities[leading[i]].has_theory) {
      scripts.push_back(deviationFigure(data, pooled, leading[i]));
    }
  }
  return scripts;
}

}  // namespace

void writeCsv(const CampaignData& data, const fs::path& folder, const PooledTable& pooled) {
  replaceFile(folder / names::kTable, runsCsv(data));
  replaceFile(folder / names::kPooled, pointsCsv(data, pooled));
  replaceFile(folder / names::kJson, campaignJson(data, pooled));
}

std::vector<std::string> writeTables(const CampaignData& data, const fs::path& folder,
                                     const PageOptions& options) {
  const PooledTable pooled = poolCampaign(data);
  writeCsv(data, folder, pooled);

  std::vector<std::string> findings;
  std::vector<std::string> shown = options.show;
  if (shown.empty() && data.request.adaptive && !pooled.quantities.empty()) {
    shown = {data.request.adaptive->quantity};
  }
  const std::vector<std::size_t> leading = [&] {
    try {
      return leadingQuantities(pooled, shown, kMostFigures);
    } catch (const UserError& error) {  // a wrong name costs no result
      findings.push_back(fmt::format("{}; the page shows what varies most", error.what()));
      return leadingQuantities(pooled, {}, kMostFigures);
    }
  }();

  std::vector<report::DrawnFigure> figures;
  if (options.figures) {
    const ScratchFolder scratch(report::makeFolderIn(folder, ".figures"));
    figures = report::drawFigureScripts(scriptsOf(data, pooled, leading), scratch.path());
    writeFigures(folder / names::kFigures, figures);
  }

  if (!data.axes.empty()) {
    for (const std::size_t quantity : leading) {
      if (auto sentence = agreementSentence(data, pooled, quantity)) {
        findings.push_back(std::move(*sentence));
      }
    }
    if (!leading.empty()) {
      if (auto sentence = powerLawSentence(data, pooled, leading.front())) {
        findings.insert(findings.begin(), std::move(*sentence));
      }
    }
  }
  const std::string name = escapeHtml(data.request.name);
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n{4}"
      "<title>{0}: campaign</title>\n<style>{1}{2}</style>\n</head>\n<body>\n<h1>{0}</h1>\n"
      "<p class=\"lead\">{3}</p>\n",
      name, report::pageStyle(), kMoreStyle, escapeHtml(requestSentence(data)),
      options.running ? "<meta http-equiv=\"refresh\" content=\"20\">\n" : "");
  const std::vector<std::string> warnings = warningsOf(data, pooled);
  if (!warnings.empty()) {
    page += "<div class=\"warn\">";
    for (const std::string& warning : warnings) {
      page += fmt::format("<p>{}</p>", escapeHtml(warning));
    }
    page += "</div>\n";
  }
  if (!findings.empty()) {
    page += "<ul>";
    for (const std::string& finding : findings) {
      page += fmt::format("<li>{}</li>\n", escapeHtml(finding));
    }
    page += "</ul>\n";
  }
  if (data.request.live) page += liveSection(folder);
  if (data.request.adaptive) {
    page += roundsSection(
        data, readRounds(readWholeFile(folder / names::kRounds, kRoundsFile).value_or(""),
                         data.axes.size()));
  }
  page += "<div class=\"figures\">\n";
  for (const report::DrawnFigure& figure : figures) page += figureHtml(figure);
  page += "</div>\n<h2>Points</h2>\n" + pointsTable(data, pooled, leading);
  page += failuresList(data);
  page += runsTable(data, folder);
  page += fmt::format(
      "<details class=\"part\"><summary><h2>Files</h2></summary><p><a href=\"{}\">a row per "
      "run</a> "
      "· <a href=\"{}\">a row per point</a> · <a href=\"{}\">both as JSON</a> · <a "
      "href=\"{}\">what "
      "was asked</a> · <a href=\"{}\">the experiment file</a></p>\n<p><code>{} sweep "
      "FOLDER{}</code> "
      "continues this campaign.</p></details>\n</body>\n</html>\n",
      names::kTable, names::kPooled, names::kJson, names::kRequest, names::kExperiment,
      installation().command, isOnRealLab(data.request) ? " --live" : "");
  replaceFile(folder / names::kPage, page);
  return findings;
}

}  // namespace lab::runner::campaign
