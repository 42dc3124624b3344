#include "dashboard/library/experiment_list.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

namespace lab::dashboard {
namespace fs = std::filesystem;
namespace {

constexpr std::uintmax_t kMostOfExperiment = 1 << 20;  // bytes

/// Fills in what the file says; false: it is no experiment.
bool readHead(ListedExperiment& experiment) {
  experiment.name = experiment.path.stem().string();
  std::error_code error;
  const std::uintmax_t size = fs::file_size(experiment.path, error);
  if (error || size > kMostOfExperiment) return false;
  try {
    const toml::table table = toml::parse_file(experiment.path.string());
    if (!table.contains("robots") && !table.contains("programs")) return false;
    experiment.name = table["name"].value_or(experiment.name);
    experiment.description = table["description"].value_or(std::string());
  } catch (const toml::parse_error& problem) {
    experiment.description = fmt::format("no TOML from line {} on", problem.source().begin.line);
  }
  return true;
}

class Listing {
 public:
  void add(const fs::path& folder, const std::string& prefix, bool shipped) {
    std::error_code error;
    const fs::path canonical = fs::canonical(folder, error);
    if (error || !folders_.insert(canonical).second) return;  // a clone ships what lies in it
    std::vector<ListedExperiment> found;
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
      if (readHead(one)) found.push_back(std::move(one));
    }
    std::ranges::sort(found, {}, &ListedExperiment::file);
    std::ranges::move(found, std::back_inserter(all));
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
  auto all = nlohmann::ordered_json::array();
  for (const ListedExperiment& one : experiments) {
    all.push_back({{"file", one.file},
                   {"name", one.name},
                   {"description", one.description},
                   {"shipped", one.shipped}});
  }
  return all.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::optional<fs::path> experimentPath(const std::vector<ListedExperiment>& experiments,
                                       std::string_view file) {
  const auto place = std::ranges::find(experiments, file, &ListedExperiment::file);
  if (place == experiments.end()) return std::nullopt;
  return place->path;
}

}  // namespace lab::dashboard
