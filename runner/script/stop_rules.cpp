#include "runner/script/stop_rules.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/experiment/script_plan.hpp"
#include "common/math/units.hpp"
#include "common/text/duration_text.hpp"

namespace lab::runner {

StopRules::StopRules(const Experiment& experiment) : any_(experiment.stop_on == StopOn::kAny) {
  for (const StopRule& rule : experiment.stop_when) {
    Rule& one = rules_.emplace_back(
        Rule{EstimatePrecision(experiment, rule.until), std::nullopt, rule.at_least});
    if (!rule.until.observable.empty()) one.crowd.emplace(experiment, rule.until);
  }
}

void StopRules::take(const analysis_t& analysis) {
  if (!begin_utime_ || analysis.utime < *begin_utime_) return;
  for (Rule& rule : rules_) {
    if (rule.crowd || !rule.estimate.take(analysis)) continue;
    rule.utime = analysis.utime;
    rule.elapsed = units::seconds(analysis.utime - *begin_utime_);
  }
}

void StopRules::take(const collective_t& message) {
  if (!begin_utime_ || message.utime < *begin_utime_) return;
  for (Rule& rule : rules_) {
    if (!rule.crowd || !rule.crowd->take(message)) continue;
    rule.utime = message.utime;
    rule.elapsed = units::seconds(message.utime - *begin_utime_);
  }
}

std::optional<std::string> StopRules::met() const {
  const auto holding = std::ranges::count_if(rules_, &Rule::holds);
  const auto enough = any_ ? 1 : static_cast<std::ptrdiff_t>(rules_.size());
  if (rules_.empty() || holding < enough) return std::nullopt;
  std::string why;
  for (const Rule& rule : rules_) {
    if (!rule.holds()) continue;
    const std::string found = rule.crowd
                                  ? rule.crowd->progress()
                                  : fmt::format("relative error {:.3g}", rule.estimate.error());
    why += fmt::format("{}{}: {} after {:.0f} s, sample {}", why.empty() ? "stop_when: " : "; ",
                       conditionText(rule.estimate.until()), found, rule.elapsed, rule.utime);
  }
  return why;
}

std::string StopRules::unmet() const {
  std::string text =
      fmt::format("stop_when was not reached{}", any_ && rules_.size() > 1 ? " (any of them)" : "");
  for (const Rule& rule : rules_) {
    if (rule.holds()) continue;
    text += fmt::format("; {}: {}", conditionText(rule.estimate.until()),
                        rule.crowd ? rule.crowd->progress() : rule.estimate.progress());
    if (rule.isMet()) text += fmt::format(", but before {} s", rule.at_least);
  }
  return text;
}

std::string StopRules::progress(const Rule& rule) const {
  const EndCondition& until = rule.estimate.until();
  if (rule.crowd) {
    return fmt::format("{}: {}", conditionText(until), rule.crowd->progress());
  }
  const std::string robot = until.robot == 0 ? "" : fmt::format(" of robot {}", until.robot);
  const std::string what = fmt::format("{} of {}{}", until.estimate, until.program, robot);
  const double wanted = until.relative_error / units::kPercent;
  const double more = rule.estimate.moreData();
  if (std::isnan(more)) return fmt::format("{} not known yet, wanted to {:.3g} %", what, wanted);
  // Assumes that data arrive at the same rate as so far.
  const double left = std::max(more * rule.elapsed, rule.at_least - rule.elapsed);
  return fmt::format("{} {:.3g} %, wanted {:.3g} %{}", what,
                     rule.estimate.error() / units::kPercent, wanted,
                     left > 0 ? ": about " + remainingTimeText(left) : "");
}

std::string StopRules::progress() const {
  std::string text;
  for (const Rule& rule : rules_) {
    text += fmt::format("{}{}", text.empty() ? "" : any_ ? " or " : ", ", progress(rule));
  }
  return text;
}

}  // namespace lab::runner
