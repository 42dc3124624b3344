/// The test for Brownian motion as JSON and HTML.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "analyzer/fits/brownian_hypothesis.hpp"

namespace lab::report {

/// One array per column, both results and the verdict in words.
[[nodiscard]] nlohmann::ordered_json brownianJson(const analysis::BrownianTest& test);

/// A paragraph of report.html.
[[nodiscard]] std::string brownianHtml(const analysis::BrownianTest& test);

}  // namespace lab::report
