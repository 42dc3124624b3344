/// Experiment files that can be started: the shipped ones, and those where the server was started.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lab::dashboard {

struct ListedExperiment {
  std::string
      file;  ///< "shipped/abp.toml", "mine.toml", "experiments/mine.toml": what it is asked by
  std::filesystem::path path;
  std::string name;
  std::string description;  ///< empty: the file says none
  bool shipped = false;
};

/// The shipped files, then *.toml of `own` and of `own`/experiments, by name. Files of TOML that
/// are no experiments are left out; broken ones are not, since `lab check` says what is wrong with
/// them.
[[nodiscard]] std::vector<ListedExperiment> listExperiments(const std::filesystem::path& shipped,
                                                            const std::filesystem::path& own);

/// Of `GET /api/experiments`.
[[nodiscard]] std::string experimentsJson(const std::vector<ListedExperiment>& experiments);

/// The path of a listed file; nothing where it is not listed.
[[nodiscard]] std::optional<std::filesystem::path> experimentPath(
    const std::vector<ListedExperiment>& experiments, std::string_view file);

}  // namespace lab::dashboard
