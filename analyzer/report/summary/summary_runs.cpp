#include <nlohmann/json.hpp>

#include "analyzer/report/sections/fit_section.hpp"
#include "analyzer/report/sections/run_section.hpp"
#include "common/text/json_number.hpp"

namespace lab::report {
namespace {

using Json = nlohmann::ordered_json;

Json test(const analysis::TestResult& result) {
  return {{"statistic", number(result.statistic)},
          {"p", number(result.p)},
          {"samples", number(result.n)}};
}

/// One array a column.
Json density(const std::vector<analysis::DensityBar>& bars, const std::string& unit) {
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
  json["exponential_run_times"] = test(runs.exponential);
  json["uniform_angles_kuiper"] = test(runs.uniform);
  json["uniform_angles_rayleigh"] = test(runs.preferred);
  json["independent_runs_correlation"] = test(runs.independent);
  json["run_time_distribution"] = density(runs.run_times, "s");
  json["turn_distribution"] = density(runs.turns, "rad");
  return json;
}

}  // namespace lab::report
