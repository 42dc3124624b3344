/// Lists the experiment files that can be started: the shipped ones and the user's.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lab::dashboard {

struct ListedExperiment {
  /// Its key in requests: "shipped/NAME.toml", "mine.toml", "experiments/mine.toml".
  std::string file;
  std::filesystem::path path;
  std::string name;
  std::string description;  ///< empty if the file has none
  bool shipped = false;
};

/// The shipped files, then *.toml of `own` and of `own`/experiments, each sorted by name. TOML
/// files that are not experiments are left out. Files with syntax errors are listed, because `lab
/// check` explains the errors.
[[nodiscard]] std::vector<ListedExperiment> listExperiments(const std::filesystem::path& shipped,
                                                            const std::filesystem::path& own);

/// The response to GET /api/experiments.
[[nodiscard]] std::string experimentsJson(const std::vector<ListedExperiment>& experiments);

/// The path of a listed file; nothing if it is not listed.
[[nodiscard]] std::optional<std::filesystem::path> experimentPath(
    const std::vector<ListedExperiment>& experiments, std::string_view file);

}  // namespace lab::dashboard
