#include "analyzer/report/sections/fit_section.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "analyzer/report/html/html_verdicts.hpp"
#include "analyzer/service/program_analysis.hpp"
#include "common/text/format.hpp"
#include "common/text/json_number.hpp"

namespace lab::report {
namespace {

using Json = nlohmann::ordered_json;
using analysis::Estimate;
using analysis::LawFit;
using analysis::LawTest;

constexpr double kTrustedGuard = 4;

Json numbers(const std::vector<double>& values) {
  Json all = Json::array();
  for (const double value : values) all.push_back(number(value));
  return all;
}

Json testJson(const std::optional<LawTest>& test) {
  if (!test || !std::isfinite(test->p_value)) return nullptr;
  return {{"p_value", number(test->p_value)},
          {"standard_deviations", number(test->deviate)},
          {"mahalanobis_squared", number(test->distance2)},
          {"degrees_of_freedom", test->freedom},
          {"speed_over_programmed", number(test->speed)},
          {"lags_s", numbers(test->lags)}};
}

std::string pText(double p) {
  if (p < 1e-6) return "p &lt; 10<sup>−6</sup>";
  return p < 1e-3 ? fmt::format("p = {:.0e}", p) : fmt::format("p = {:.3f}", p);
}

std::string testText(const std::optional<LawTest>& test, const char* what) {
  if (!test || !std::isfinite(test->p_value)) {
    return fmt::format("<li>{}: too few lags for a test.</li>\n", what);
  }
  constexpr double kRejected = 0.001;
  return fmt::format("<li>{}: {} by the data, {} ({:.1f} σ; {} degrees of freedom).</li>\n", what,
                     test->p_value < kRejected ? "rejected" : "not rejected", pText(test->p_value),
                     test->deviate, test->freedom);
}

}  // namespace

Json estimatesJson(const std::vector<analysis::Estimate>& estimates) {
  Json all = Json::object();
  for (const analysis::Estimate& estimate : estimates) {
    const DisplayUnit unit = displayUnit(estimate.unit);
    all[unit.key.empty() ? estimate.name : estimate.name + "_" + unit.key] = {
        {"value", number(estimate.value * unit.factor)},
        {"standard_error", number(estimate.sigma * unit.factor)},
        {"low95", number(estimate.low95 * unit.factor)},
        {"high95", number(estimate.high95 * unit.factor)},
        {"theory", number(estimate.theory * unit.factor)},
        {"effective_samples", number(estimate.n_eff)},
        {"note", estimate.note}};
  }
  return all;
}

Json fitJson(const LawFit& fit) {
  Json json;
  json["refusal"] = fit.fitted() ? Json(nullptr) : Json(fit.refusal);
  if (!fit.fitted()) return json;
  json["estimator"] = fit.angular ? "GLS, exact law, MSD and angular MSD" : "GLS, exact law, MSD";
  json["parameters"] = estimatesJson(fit.parameters);
  json["derived"] = estimatesJson(fit.derived);
  json["correlation"] = numbers(fit.correlation);
  json["lags_s"] = numbers(fit.lags);
  json["chi_squared"] = number(fit.chi2);
  json["degrees_of_freedom"] = fit.freedom;
  json["p_value"] = number(fit.p_value);
  json["describes_the_data"] = !(fit.p_value < analysis::kUnlikely);
  json["least_squares_guard_z"] = number(fit.guard_z);
  json["covariance"] = {{"films", fit.recordings},
                        {"film_s", number(fit.recording_duration)},
                        {"regularised", fit.regularised}};
  json["test_exact"] = testJson(fit.exact);
  json["test_exact_msd"] = testJson(fit.exact_msd);
  json["test_paper_msd"] = testJson(fit.paper);
  return json;
}

std::string fitHtml(const LawFit& fit) {
  if (!fit.fitted()) {
    return fmt::format("<h4>Fit of the exact law</h4>\n<p class=\"soft\">No fit: {}.</p>\n",
                       escapeHtml(fit.refusal));
  }
  std::vector<Estimate> all = fit.parameters;
  all.insert(all.end(), fit.derived.begin(), fit.derived.end());
  const bool describes = !(fit.p_value < analysis::kUnlikely);
  std::string html = "<h4>Fit of the exact law</h4>\n";
  if (!describes) {
    html +=
        "<p class=\"deviates\">The fitted law does not describe the curves. These are the "
        "parameters that come nearest, not those of the motion.</p>\n";
  }
  html += html::estimateTable(all) + "<ul>\n";
  html += fmt::format(
      "<li>The fitted law describes the curves with {} (χ² = {:.1f}, {} degrees of "
      "freedom; covariance of {} simulated recordings).</li>\n",
      pText(fit.p_value), fit.chi2, fit.freedom, fit.recordings);
  if (fit.guard_z > kTrustedGuard) {
    html += fmt::format(
        "<li class=\"deviates\">Generalised and ordinary least squares differ by "
        "{:.1f} σ: do not trust this fit.</li>\n",
        fit.guard_z);
  }
  html += testText(fit.exact, "The exact law with the programmed parameters, MSD and angular MSD");
  html += testText(fit.exact_msd, "The exact law with the programmed parameters, MSD");
  html += testText(fit.paper, "The paper's formula with the programmed parameters, MSD");
  return html + "</ul>\n";
}

}  // namespace lab::report
