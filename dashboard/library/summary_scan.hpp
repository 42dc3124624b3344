/// Reads from a summary.json what the list of runs shows.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lab::dashboard {

struct SummaryFacts {
  struct Program {
    std::string name;
    std::string verdict;
    std::optional<double> max_z;
    bool restricted = false;  ///< an agreement is not shown in green
  };

  std::string experiment;
  std::optional<double> duration_s;
  std::int64_t faults = 0;
  std::int64_t lost = 0;  ///< messages missing in the log
  std::vector<Program> programs;
};

/// Parses without building a document, so that a thousand summaries are read quickly.
/// @return nothing if the text is not a summary.json
[[nodiscard]] std::optional<SummaryFacts> scanSummary(std::string_view text);

}  // namespace lab::dashboard
