#include "report/json_numbers.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "report/people.hpp"

namespace lab::report {

using Json = nlohmann::ordered_json;

Json number(double value) {
  if (!std::isfinite(value)) return nullptr;
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  const double rounded = std::strtod(text.data(), nullptr);
  return rounded == 0 ? 0.0 : rounded;  // no -0
}

Json estimatesJson(const std::vector<analysis::Estimate>& estimates) {
  Json all = Json::object();
  for (const analysis::Estimate& estimate : estimates) {
    const PeopleUnit unit = peopleUnit(estimate.unit);
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

}  // namespace lab::report
