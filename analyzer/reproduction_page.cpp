#include "analyzer/reproduction_page.hpp"

#include <fmt/format.h>

#include <cmath>

#include "analyzer/report/figures/figure_files.hpp"
#include "analyzer/report/figures/gnuplot.hpp"
#include "analyzer/report/html/html_sections.hpp"
#include "analyzer/report/html/html_style.hpp"
#include "analyzer/report/html/html_verdicts.hpp"
#include "analyzer/report/reproduction/reproduction_figures.hpp"
#include "analyzer/report_error.hpp"
#include "common/files/atomic_file.hpp"
#include "common/process/version.hpp"
#include "common/text/format.hpp"

namespace lab::report {
namespace fs = std::filesystem;
namespace {

using analysis::Estimate;
using analysis::VerdictKind;

constexpr const char* kMoreStyle = R"css(
.panels { display: grid; grid-template-columns: repeat(auto-fit, minmax(19rem, 1fr)); gap: 1.4rem; }
.rejected { color: var(--bad); } .held { color: var(--soft); }
body { max-width: 78rem; }
@media print { .panels { grid-template-columns: 1fr 1fr 1fr; gap: .6rem; } body { font-size: 9pt; padding: 0; } }
)css";

std::string sentence(std::string text) {
  if (!text.empty() && text.back() != '.') text += ".";
  return text;
}

std::string figureHtml(const PaperPanel& panel, const Figure& figure,
                       const Reproduction& reproduction) {
  const std::string drawing =
      figure.svg.empty() ? fmt::format("<p class=\"soft\">{}</p>", escapeHtml(figure.sentence))
                         : inlineSvg(figure.svg, figure.name + "_");
  std::string caption = fmt::format("<b>{} {}.</b> {}", panel.id, escapeHtml(panel.title),
                                    escapeHtml(sentence("In the paper’s text: " + panel.given)));
  if (!panel.chosen.empty()) {
    caption += " <b>Chosen here:</b> " + escapeHtml(sentence(panel.chosen));
  }
  if (!figure.caption.empty()) caption += " " + escapeHtml(sentence(figure.caption));
  const PanelVerdict verdict = judgePanel(panel, reproduction);
  if (!verdict.exact_text.empty()) {
    caption += fmt::format("<br><b class=\"{}\">{}</b>: {}", html::verdictClass(verdict.exact),
                           escapeHtml(verdictWord(verdict.exact)),
                           escapeHtml(sentence(verdict.exact_text)));
  }
  if (!verdict.paper_text.empty()) {
    caption += fmt::format("<br><span class=\"{}\">{}</span>",
                           verdict.paper == PaperVerdict::kRejected ? "rejected" : "held",
                           escapeHtml(sentence(verdict.paper_text)));
  }
  return fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", drawing, caption);
}

std::string summaryTable(const std::vector<PaperPanel>& panels, const Reproduction& reproduction) {
  html::Table table({"panel", "the exact law", ">max |z|", "the paper’s formula"});
  for (const PaperPanel& panel : panels) {
    const PanelVerdict verdict = judgePanel(panel, reproduction);
    if (verdict.exact_text.empty()) continue;
    const std::string paper = verdict.paper == PaperVerdict::kRejected
                                  ? "<span class=\"rejected\">rejected by these data</span>"
                              : verdict.paper == PaperVerdict::kNotRejected ? "not rejected"
                              : verdict.paper == PaperVerdict::kUndecided   ? "undecided"
                                                                            : "–";
    table.row(
        {panel.id + " " + escapeHtml(panel.title),
         fmt::format("<span class=\"{}\">{}</span>", html::verdictClass(verdict.exact),
                     verdictWord(verdict.exact)),
         verdict.exact == VerdictKind::kUndecided ? "–" : fmt::format("{:.1f}", verdict.max_z),
         (panel.formula.empty() ? "" : escapeHtml(panel.formula) + ": ") + paper});
  }
  return table.text();
}

std::string estimateTable(const Reproduction& reproduction, std::string& csv) {
  html::Table table({"set", "quantity", ">measured", ">95 %", ">theory", ">z", "estimator"});
  CsvText file("set,quantity,unit,value,standard_error,low95,high95,theory,z,estimator");
  for (const PaperSet& set : paperSets()) {
    const auto found = reproduction.find(set.id);
    if (found == reproduction.end() || found->second.recordings.empty()) continue;
    std::string name = set.id;
    for (const Estimate& estimate : estimatesOf(found->second)) {
      const DisplayUnit unit = displayUnit(estimate.unit);
      const double f = unit.factor;
      const double z = (estimate.value - estimate.theory) / estimate.sigma;
      file.row(set.id, estimate.name, unit.key, estimate.value * f, estimate.sigma * f,
               estimate.low95 * f, estimate.high95 * f, estimate.theory * f, z, estimate.note);
      const double error = estimate.sigma * f;
      table.row({std::exchange(name, ""), symbolHtml(estimate.name),
                 fmt::format("{} ± {} {}", valueText(estimate.value * f, error),
                             valueText(error, error), escapeHtml(unit.text)),
                 fmt::format("{} to {}", valueText(estimate.low95 * f, error),
                             valueText(estimate.high95 * f, error)),
                 std::isfinite(estimate.theory) ? shortText(estimate.theory * f) : "–",
                 std::isfinite(z) ? fmt::format("{:+.1f}", z) : "–", escapeHtml(estimate.note)});
    }
  }
  csv = file.text();
  return table.text();
}

std::string lead(const ReproductionFacts& facts) {
  std::string text = fmt::format("{} a set, seed {}", durationText(facts.hours * 3600), facts.seed);
  if (facts.ensemble > 1) text += fmt::format(", {} recordings each", facts.ensemble);
  text += facts.through_firmware ? ", the firmware on simulated chips" : ", simulated robots";
  return text + ", virtual time, version " + kVersion;
}

std::string pageText(const std::vector<PaperPanel>& panels, const Reproduction& reproduction,
                     const std::vector<Figure>& figures, const ReproductionFacts& facts,
                     std::string& estimates) {
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>Reproduction of the paper’s figures</title>\n<style>{}{}</style>\n</head>\n<body>\n"
      "<h1>Figures 2, 3 and 4, reproduced</h1>\n<p class=\"lead\">{}</p>\n"
      "<p>Each program was run through the whole lab: services, messages, log, walls at which the "
      "robot drives 40 cm back, stitching, a tracker’s noise (0.03 cm, 0.6°), 50 frames a second, "
      "clock errors and PWM steps. Points are measured, bars one standard error. <b>Exact law</b>: "
      "what the robot executes, with draws held for ε. <b>Paper</b>: its formula, which neglects "
      "ε. "
      "A panel agrees while no judged lag is 4 standard errors off; chance exceeds 3.2 in one "
      "recording "
      "of a hundred. A formula is rejected where p &lt; 0.001, with the speed free.</p>\n",
      html::kStyle, kMoreStyle, escapeHtml(lead(facts)));
  std::string faults;
  for (const auto& [id, set] : reproduction) {
    for (const RecordingData& recording : set.recordings) {
      for (const std::string& fault : recording.faults) {
        faults += fmt::format("<p><b>{}:</b> {}</p>\n", id, escapeHtml(fault));
      }
    }
  }
  if (!faults.empty()) page += "<div class=\"warn\">\n" + faults + "</div>\n";
  page += summaryTable(panels, reproduction);
  std::string open;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const std::string number = panels[i].id.substr(0, 1);
    if (number != open) {
      page += fmt::format("{}<h2>Figure {}</h2>\n{}<div class=\"panels\">\n",
                          open.empty() ? "" : "</div>\n", number,
                          number == "4" ? "<p class=\"soft\">4a is a drawing of a run and a tumble."
                                          "</p>\n"
                                        : "");
      open = number;
    }
    page += figureHtml(panels[i], figures[i], reproduction);
  }
  page += "</div>\n<h2>Estimates beside theory</h2>\n" + estimateTable(reproduction, estimates);
  return page + "</body>\n</html>\n";
}

}  // namespace

WrittenReproduction writeReproduction(const fs::path& out, const std::vector<PaperPanel>& panels,
                                      const Reproduction& reproduction,
                                      const ReproductionFacts& facts) {
  const fs::path scratch = out / ".drawing";
  std::error_code error;
  fs::remove_all(scratch, error);  // of an interrupted command; of a link only the link
  fs::create_directories(scratch, error);
  if (error)
    throw ReportError(fmt::format("{}: cannot write here; choose another --out", out.string()));
  const std::vector<Figure> figures = drawScripts(panelFigures(panels, reproduction), scratch);
  fs::remove_all(scratch);
  for (const Figure& figure : figures) {
    if (figure.svg.empty()) continue;
    replaceFile(out / (figure.name + ".svg"), figure.svg);
    replaceFile(out / (figure.name + ".pdf"), figure.pdf);
    replaceFile(out / (figure.name + ".csv"), figure.csv);
  }
  std::string estimates;
  const std::string page = pageText(panels, reproduction, figures, facts, estimates);
  replaceFile(out / "estimates.csv", estimates);
  WrittenReproduction written;
  written.page = out / "reproduction.html";
  replaceFile(written.page, page);
  for (const PaperPanel& panel : panels) {
    const PanelVerdict verdict = judgePanel(panel, reproduction);
    if (verdict.exact_text.empty()) continue;
    written.lines.push_back(fmt::format("{}  {}, {}. {}", panel.id, verdictWord(verdict.exact),
                                        verdict.exact_text, verdict.paper_text));
  }
  return written;
}

}  // namespace lab::report
