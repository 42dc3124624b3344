/// Experiment files for tests.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/experiment/experiment_file.hpp"

namespace lab {

/// A minimal valid experiment.
inline constexpr std::string_view kSmall = R"(fileversion = 1
name = "small"
duration_s = 60
program = "abp"
[[robots]]
id = 1
[programs.abp]
model = "abp"
v_cm_s = 3
epsilon_s = 0.5
eta_rad_s = 3
)";

/// kSmall with `more` appended and with overrides.
inline Experiment small(std::string_view more = {},
                        const std::vector<std::string>& overrides = {}) {
  return parseExperiment(std::string(kSmall) + std::string(more), "small.toml", overrides);
}

/// The problems of kSmall with `more`; empty if it is valid.
inline std::vector<std::string> problemsOf(std::string_view more,
                                           const std::vector<std::string>& overrides = {}) {
  try {
    static_cast<void>(small(more, overrides));
  } catch (const ExperimentError& error) {
    return error.problems();
  }
  return {};
}

/// The *.toml files of a folder below the project's root, sorted.
inline std::vector<std::filesystem::path> tomlFiles(const std::string& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(LAB_ROOT) / folder)) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

}  // namespace lab
