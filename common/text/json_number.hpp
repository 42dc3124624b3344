/// Numbers as summary.json writes them.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace lab {

/// Rounded to six figures; null where it is no number.
[[nodiscard]] nlohmann::ordered_json number(double value);

}  // namespace lab
