/// The summary of a run without its report: for campaigns, whose runs are many and short.
#pragma once

#include <filesystem>
#include <string>

#include "analyzer/analyze_run.hpp"

namespace lab::report {

/// The text that analyzeRun() writes into summary.json. Writes nothing.
/// @throws ReportError if the log cannot be used
[[nodiscard]] std::string summaryOfRun(const std::filesystem::path& run_or_log,
                                       const AnalyzeOptions& options);

}  // namespace lab::report
