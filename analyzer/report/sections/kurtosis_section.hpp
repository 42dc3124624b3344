/// The test of the kurtosis as JSON and HTML.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "analyzer/fits/kurtosis_hypothesis.hpp"

namespace lab::report {

/// One array per column, both results and the verdict in words.
[[nodiscard]] nlohmann::ordered_json kurtosisJson(const analysis::KurtosisTest& test);

/// A paragraph of report.html.
[[nodiscard]] std::string kurtosisHtml(const analysis::KurtosisTest& test);

}  // namespace lab::report
