#include "analyzer/report/summary/diffusion_sentence.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "analyzer/report/summary/findings.hpp"
#include "common/text/format.hpp"

namespace lab::report {
namespace {

/// "D = 0.42 ± 0.07 cm²/s (law: 0.41)"; empty where D or its error was not measured.
std::string diffusivityText(const analysis::ProgramResult& result) {
  for (const analysis::Estimate& estimate : result.estimates) {
    if (estimate.name != "D" || !std::isfinite(estimate.value)) continue;
    if (!std::isfinite(estimate.sigma) || estimate.sigma <= 0) continue;
    const DisplayUnit unit = displayUnit(estimate.unit);
    const double error = estimate.sigma * unit.factor;
    const std::string law =
        std::isfinite(estimate.theory)
            ? fmt::format(" (law: {})", shortText(estimate.theory * unit.factor))
            : "";
    return fmt::format("D = {} ± {} {}{}", valueText(estimate.value * unit.factor, error),
                       valueText(error, error), unit.text, law);
  }
  return {};
}

}  // namespace

std::string diffusionSentence(const RunRecord& record) {
  std::vector<std::string> parts;
  int robots = 0;
  for (const Finding& finding : findingsOf(record)) {
    const std::string text = diffusivityText(finding.pool->result);
    if (text.empty()) continue;
    parts.push_back(fmt::format("{}: {}", finding.name, text));
    robots = std::max(robots, finding.pool->result.robots);
  }
  if (parts.empty()) return {};
  return fmt::format("diffusion of {}, measured ± standard error: {}", countText(robots, "robot"),
                     fmt::join(parts, "; "));
}

}  // namespace lab::report
