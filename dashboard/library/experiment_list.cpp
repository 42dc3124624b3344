#include "dashboard/library/experiment_list.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <set>

#include "common/files/file_text.hpp"
#include "common/files/toml_text.hpp"
#include "dashboard/web/json.hpp"

namespace lab::dashboard {
namespace fs = std::filesystem;
namespace {

/// Reads name and description. @return false if the file is not an experiment
bool readHead(ListedExperiment& experiment) {
  experiment.name = experiment.path.stem().string();
  const auto text = readWholeFile(experiment.path, file_kinds::kExperiment);
  if (!text) return false;
  try {
    const toml::table table = keys::parseToml(*text, experiment.file);
    if (!table.contains("robots") && !table.contains("programs")) return false;
    experiment.name = table["name"].value_or(experiment.name);
    experiment.description = table["description"].value_or(std::string());
  } catch (const keys::TomlError& problem) {
    const bool deep_key = problem.at().column == 0;
    experiment.description =
        fmt::format("{} in line {}", deep_key ? "found a key of too many names" : "syntax error",
                    problem.at().line);
  }
  return true;
}

class Listing {
 public:
  void add(const fs::path& folder, const std::string& prefix, bool shipped) {
    std::error_code error;
    const fs::path canonical = fs::canonical(folder, error);
    if (error || !folders_.insert(canonical).second)
      return;  // in a source tree both are the same folder
    std::vector<ListedExperiment> listed;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error)) {
      const std::string file = entry->path().filename().string();
      std::error_code unreadable;
      if (entry->path().extension() != ".toml" || file.starts_with('.')) continue;
      if (!entry->is_regular_file(unreadable)) continue;
      ListedExperiment one{.file = prefix + file,
                           .path = fs::absolute(entry->path()),
                           .name = {},
                           .description = {},
                           .shipped = shipped};
      if (readHead(one)) listed.push_back(std::move(one));
    }
    std::ranges::sort(listed, {}, &ListedExperiment::file);
    std::ranges::move(listed, std::back_inserter(all));
  }

  std::vector<ListedExperiment> all;

 private:
  std::set<fs::path> folders_;
};

}  // namespace

std::vector<ListedExperiment> listExperiments(const fs::path& shipped, const fs::path& own) {
  Listing listing;
  listing.add(shipped, "shipped/", true);
  listing.add(own, "", false);
  listing.add(own / "experiments", "experiments/", false);
  return std::move(listing.all);
}

std::string experimentsJson(const std::vector<ListedExperiment>& experiments) {
  Json all = Json::array();
  for (const ListedExperiment& one : experiments) {
    all.push_back({{"file", one.file},
                   {"name", one.name},
                   {"description", one.description},
                   {"shipped", one.shipped}});
  }
  return toText(all);
}

std::optional<fs::path> experimentPath(const std::vector<ListedExperiment>& experiments,
                                       std::string_view file) {
  const auto found = std::ranges::find(experiments, file, &ListedExperiment::file);
  if (found == experiments.end()) return std::nullopt;
  return found->path;
}

}  // namespace lab::dashboard
