#include "runner/command_line/experiment_lookup.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <vector>

#include "common/text/nearest_word.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

bool isFile(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error) && !fs::is_directory(path, error);
}

}  // namespace

std::vector<std::string> tomlNamesIn(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  }
  std::ranges::sort(names);
  return names;
}

fs::path findExperiment(const fs::path& named, const fs::path& shipped) {
  // A path with a folder is returned as it is: the reader of experiment files reports its errors.
  if (named.empty() || named.has_parent_path() || isFile(named)) return named;
  fs::path file = shipped / named;
  if (named.extension() != ".toml") file += ".toml";
  if (isFile(file)) return file;
  std::error_code error;
  if (fs::is_directory(named, error)) {
    throw UserError(named.string() + ": is a folder, expected an experiment file");
  }
  const std::vector<std::string> names = tomlNamesIn(shipped);
  std::string meant = didYouMean(named.stem().string(), names);
  if (meant.empty()) {
    std::vector<std::string> here = tomlNamesIn(".");
    for (std::string& name : here) name += ".toml";
    meant = didYouMean(named.string(), here);
  }
  throw UserError(fmt::format("no experiment {}: looked for the files {} and {}; {}{}",
                              named.string(), fs::absolute(named).string(), file.string(),
                              names.empty() ? "no experiment is shipped there"
                                            : fmt::format("there are {}", fmt::join(names, ", ")),
                              meant));
}

}  // namespace lab::runner
