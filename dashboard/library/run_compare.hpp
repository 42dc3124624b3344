/// Reads the curves of past runs for comparison.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace lab::dashboard {

/// One entry of the response to GET /api/compare for each program in a run's summary.json, in the
/// form of topic `pool/...`.
/// @param summary the text of the file
/// @throws std::runtime_error if it is not a summary.json
[[nodiscard]] nlohmann::ordered_json curvesOf(const std::string& run, const std::string& summary);

}  // namespace lab::dashboard
