/// Numbers in summary.json.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace lab {

/// Rounded to six significant figures; null if not finite.
[[nodiscard]] nlohmann::ordered_json number(double value);

}  // namespace lab
