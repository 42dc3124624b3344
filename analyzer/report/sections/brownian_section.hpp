/// The test for Brownian motion as people and programs read it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "analyzer/fits/brownian_hypothesis.hpp"

namespace lab::report {

/// One array a column, both answers and the verdict in words.
[[nodiscard]] nlohmann::ordered_json brownianJson(const analysis::BrownianTest& test);

/// A paragraph of the report's page.
[[nodiscard]] std::string brownianHtml(const analysis::BrownianTest& test);

}  // namespace lab::report
