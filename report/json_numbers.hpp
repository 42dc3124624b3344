/// Numbers as summary.json writes them.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "analyzer/estimates.hpp"

namespace lab::report {

/// Rounded to six figures; null where it is no number.
[[nodiscard]] nlohmann::ordered_json number(double value);

/// Each estimate under its name with its unit, in people's units.
[[nodiscard]] nlohmann::ordered_json estimatesJson(
    const std::vector<analysis::Estimate>& estimates);

}  // namespace lab::report
