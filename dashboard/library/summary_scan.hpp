/// The few numbers of a summary.json that a list of runs shows.
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
  };

  std::string experiment;
  std::optional<double> duration_s;
  std::int64_t faults = 0;
  std::int64_t lost = 0;  ///< messages that the log lacks
  std::vector<Program> programs;
};

/// Reads on the fly, for a thousand of them: no document is built. Nothing: it is no summary.json.
[[nodiscard]] std::optional<SummaryFacts> scanSummary(std::string_view text);

}  // namespace lab::dashboard
