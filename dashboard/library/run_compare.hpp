/// The curves of several runs beside each other.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace lab::dashboard {

/// Of `GET /api/compare`: one entry for each program of a run's summary.json, in the form of topic
/// `pool/...`. @throws std::runtime_error where the text is no summary.json.
[[nodiscard]] nlohmann::ordered_json curvesOf(const std::string& run, const std::string& summary);

}  // namespace lab::dashboard
