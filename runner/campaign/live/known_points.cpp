#include "runner/campaign/live/known_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "common/text/nearest_word.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner::campaign {
namespace {

constexpr int kFewestRuns = 2;  // one run has no scatter

bool isMeant(const Quantity& quantity, const KnownRule& rule) {
  return quantity.has_errors &&
         (quantity.name == rule.quantity || quantity.name.ends_with("." + rule.quantity));
}

std::vector<std::size_t> quantitiesOf(const PooledTable& pooled, const KnownRule& rule) {
  std::vector<std::size_t> meant;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < pooled.quantities.size(); ++i) {
    if (pooled.quantities[i].has_errors) names.push_back(pooled.quantities[i].name);
    if (isMeant(pooled.quantities[i], rule)) meant.push_back(i);
  }
  if (meant.empty()) {
    throw UserError(fmt::format("--known {}: the runs have no such estimate, expected one of {}",
                                knownRuleText(rule), fmt::join(names, ", ")));
  }
  return meant;
}

bool isKnown(const PooledNumber& number, double relative) {
  return number.runs >= kFewestRuns && std::isfinite(number.sigma) &&
         number.sigma <= relative * std::abs(number.mean);
}

}  // namespace

std::vector<std::size_t> knownPoints(const PooledTable& pooled,
                                     const std::vector<KnownRule>& rules) {
  std::vector<std::size_t> known;
  if (rules.empty() || pooled.quantities.empty()) return known;
  for (std::size_t point = 0; point < pooled.points.size(); ++point) {
    const bool all = std::ranges::all_of(rules, [&](const KnownRule& rule) {
      return std::ranges::all_of(quantitiesOf(pooled, rule), [&](std::size_t quantity) {
        return isKnown(pooled.points[point].numbers[quantity], rule.relative);
      });
    });
    if (all) known.push_back(point);
  }
  return known;
}

}  // namespace lab::runner::campaign
