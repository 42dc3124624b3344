#include "analyzer/report/sections/run_section.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "analyzer/report/html/html_sections.hpp"
#include "analyzer/report/html/html_verdicts.hpp"
#include "analyzer/report/sections/fit_section.hpp"
#include "common/math/units.hpp"
#include "common/text/format.hpp"
#include "common/text/json_number.hpp"

namespace lab::report {
namespace {

using Json = nlohmann::ordered_json;

Json testJson(const analysis::TestResult& result) {
  return {{"statistic", number(result.statistic)},
          {"p", number(result.p)},
          {"samples", number(result.n)}};
}

/// One array per column.
Json densityJson(const std::vector<analysis::DensityBar>& bars, const std::string& unit) {
  Json low = Json::array();
  Json high = Json::array();
  Json value = Json::array();
  Json error = Json::array();
  Json count = Json::array();
  Json theory = Json::array();
  for (const analysis::DensityBar& bar : bars) {
    low.push_back(number(bar.low));
    high.push_back(number(bar.high));
    value.push_back(number(bar.density));
    error.push_back(number(bar.sigma));
    count.push_back(number(bar.count));
    theory.push_back(number(bar.theory));
  }
  return {{"from_" + unit, low},
          {"to_" + unit, high},
          {"density_per_" + unit, value},
          {"standard_error_per_" + unit, error},
          {"count", count},
          {"theory_per_" + unit, theory}};
}

}  // namespace

Json runsJson(const analysis::RunStatistics& runs, bool whole) {
  if (!runs.problem.empty()) return {{"problem", runs.problem}};
  Json json;
  json["observed_s"] = number(runs.observed);
  json["tumbles"] = runs.tumbles;
  json["runs"] = runs.runs;
  json["runs_cut_off"] = runs.cut_off;
  json["runs_too_short_to_see"] = runs.hidden;
  json["shortest_run_s"] = number(runs.shortest);
  json["estimates"] = estimatesJson(runs.estimates);
  if (!whole) return json;
  json["tumble_time_scatter_s"] = number(runs.tumble_scatter);
  json["wheel_speed_of_99_percent_of_turns_cm_s"] = number(runs.wheel_speed * 100);
  json["wheel_speed_needed_for_half_a_turn_cm_s"] = number(runs.needed_wheel_speed * 100);
  json["share_turned_beyond_180_degrees"] = number(runs.beyond_half_turn);
  json["exponential_run_times"] = testJson(runs.exponential);
  json["uniform_angles_kuiper"] = testJson(runs.uniform);
  json["uniform_angles_rayleigh"] = testJson(runs.preferred);
  json["independent_runs_correlation"] = testJson(runs.independent);
  json["run_time_distribution"] = densityJson(runs.run_times, "s");
  json["turn_distribution"] = densityJson(runs.turns, "rad");
  return json;
}

namespace html {
namespace {

using analysis::RunStatistics;
using analysis::TestResult;
using units::kCm;
using units::kPercents;

constexpr double kRejected = 0.01;

std::string pText(double p) {
  if (!std::isfinite(p)) return "–";
  return p < 1e-3 ? "&lt; 0.001" : fmt::format("{:.3f}", p);
}

void testRow(Table& table, const char* hypothesis, const char* how, const TestResult& test) {
  const bool rejected = test.p < kRejected;
  const char* answer = rejected ? "rejected" : "not rejected";
  table.row({hypothesis,
             fmt::format("<span{}>{}</span>", rejected ? " class=\"deviates\"" : "",
                         std::isfinite(test.p) ? answer : "too few data"),
             pText(test.p), shortText(test.statistic),
             groupedText(static_cast<std::int64_t>(test.n)),
             fmt::format("<span class=\"soft\">{}</span>", how)});
}

std::string tests(const RunStatistics& runs) {
  Table table({"hypothesis", "result", ">p", ">statistic", ">samples", "test"});
  testRow(table, "run times are exponential",
          "largest distance from the fitted exponential law (Lilliefors), with cut-off runs as "
          "censored data; p from 499 simulated sets",
          runs.exponential);
  testRow(table, "tumble angles are uniform", "Kuiper", runs.uniform);
  testRow(table, "no direction is preferred", "Rayleigh", runs.preferred);
  testRow(table, "successive runs are independent", "correlation of successive run times",
          runs.independent);
  return table.text();
}

/// Remarks on wheels that limit the tumbles.
std::string wheels(const RunStatistics& runs, double limit) {
  std::string html;
  if (runs.needed_wheel_speed > limit) {
    html += fmt::format(
        "<li><b>The wheels are too slow for these tumbles:</b> half a turn in the programmed "
        "<i>τ</i><sub>t</sub> needs {} cm/s, and they reach {}. Larger turns are incomplete, the "
        "angles are not uniform, and <i>D</i> is not that of eq. 6.</li>\n",
        shortText(runs.needed_wheel_speed * kCm), shortText(limit * kCm));
  } else if (runs.wheel_speed > 0.98 * limit) {
    html += fmt::format(
        "<li><b>Tumbles at the limit of the wheels:</b> turns need wheel speeds up to {} cm/s, and "
        "the wheels reach {}. Some turns may be incomplete.</li>\n",
        shortText(runs.wheel_speed * kCm), shortText(limit * kCm));
  }
  if (runs.beyond_half_turn > kRejected) {
    html += fmt::format(
        "<li>{:.0f} % of the tumbles turned by more than 180°: the robots do not turn in the "
        "shorter "
        "direction. Positions do not show this; the angular MSD does.</li>\n",
        runs.beyond_half_turn * kPercents);
  }
  return html;
}

std::string card(const Finding& finding, double limit) {
  const RunStatistics& runs = *finding.pool->result.runs;
  std::string html =
      fmt::format("<section class=\"card\">\n<h3>{}</h3>\n", escapeHtml(finding.name));
  if (!runs.problem.empty()) {
    return html +
           fmt::format("<p>No runs from poses: {}.</p>\n</section>\n", escapeHtml(runs.problem));
  }
  html += fmt::format(
      "<p>{} began in {} of free motion. {} were observed from tumble to tumble. {} were cut off "
      "by the end of a track. {} were too short to detect (below {} s); their number is inferred "
      "from the durations of the stops.</p>\n",
      countText(runs.tumbles, "tumble"), durationText(runs.observed), countText(runs.runs, "run"),
      groupedText(runs.cut_off), groupedText(runs.hidden), shortText(runs.shortest));
  const std::string remarks = wheels(runs, limit);
  if (!remarks.empty()) html += "<ul>\n" + remarks + "</ul>\n";
  return html + estimateTable(runs.estimates) + tests(runs) + "</section>\n";
}

}  // namespace

std::string runs(const std::vector<Finding>& findings, double max_wheel_speed) {
  std::string cards;
  for (const Finding& finding : findings) {
    if (finding.pool->result.runs) cards += card(finding, max_wheel_speed);
  }
  if (cards.empty()) return {};
  return "<h2>Runs and tumbles</h2>\n<p>Found in the poses alone, independent of the telemetry: a "
         "tumble is a stop, a run is the straight path between two stops.</p>\n" +
         cards;
}

}  // namespace html
}  // namespace lab::report
