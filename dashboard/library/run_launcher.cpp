#include "dashboard/library/run_launcher.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "dashboard/control/json_object_reader.hpp"
#include "dashboard/library/experiment_list.hpp"
#include "dashboard/views/json.hpp"

namespace lab::dashboard {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMaxSettings = 64;
constexpr std::size_t kMaxSettingText = 1000;  // characters
constexpr std::chrono::seconds kCheckTimeout{20};
constexpr const char* kAddress = "address.txt";

RunLauncher::Response refusal(int status, const std::string& why) {
  return {status, toText(Json{{"error", why}})};
}

/// The experiment file and the settings that are to be checked or run.
struct Selection {
  std::string file;
  std::vector<std::string> set;

  explicit Selection(JsonObjectReader& json)
      : file(json.text("file", kMaxSettingText)),
        set(json.texts("set", kMaxSettings, kMaxSettingText)) {
    for (const std::string& one : set) {
      if (one.find('=') == std::string::npos || one.starts_with('=')) {
        throw JsonObjectError(fmt::format("set: found \"{}\", expected key=value", one));
      }
    }
  }

  /// The command line `lab COMMAND FILE --set=KEY=VALUE ...`.
  [[nodiscard]] std::vector<std::string> arguments(const fs::path& programs, const char* command,
                                                   const fs::path& path) const {
    std::vector<std::string> all{(programs / "lab").string(), command, path.string()};
    for (const std::string& one : set) all.push_back("--set=" + one);
    return all;
  }
};

std::string notListed(const std::string& file) {
  return fmt::format("file: found \"{}\", expected a file of GET /api/experiments", file);
}

/// The name of the run's folder, from the output line "run      FOLDER"; null until it is printed.
Json runOf(const std::string& output) {
  std::istringstream lines(output);
  for (std::string line; std::getline(lines, line);) {
    constexpr std::string_view kWord = "run ";
    if (!line.starts_with(kWord)) continue;
    const std::size_t begin = line.find_first_not_of(' ', kWord.size());
    if (begin != std::string::npos) return fs::path(line.substr(begin)).filename().string();
  }
  return {};
}

/// Null until the file is written.
Json addressIn(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  if (!std::getline(stream, line) || !line.starts_with("http://")) return {};
  return line;
}

/// Removes the token: clients without it may read the output too.
std::string withoutToken(std::string text) {
  constexpr std::string_view kToken = "#token=";
  for (std::size_t at = 0; (at = text.find(kToken, at)) != std::string::npos;) {
    at += kToken.size();
    const std::size_t end = std::min(text.find_first_of(" \r\n\t", at), text.size());
    text.replace(at, end - at, "...");
  }
  return text;
}

}  // namespace

std::string RunLauncher::experiments() const {
  return experimentsJson(listExperiments(folders_.experiments, folders_.own));
}

RunLauncher::Response RunLauncher::check(std::string_view body) {
  JsonObjectReader json(body);
  const Selection selection(json);
  json.finish();
  const auto path =
      experimentPath(listExperiments(folders_.experiments, folders_.own), selection.file);
  if (!path) return refusal(404, notListed(selection.file));
  const std::lock_guard lock(checking_);
  const CommandResult result =
      runCommand(selection.arguments(folders_.programs, "check", *path), kCheckTimeout, closing_);
  const std::string killed = result.was_killed ? "ended because it took longer than 20 s\n" : "";
  return {200, toText(Json{{"ok", result.code == 0}, {"text", result.output + killed}})};
}

RunLauncher::Response RunLauncher::start(std::string_view body) {
  JsonObjectReader json(body);
  const Selection selection(json);
  const bool virtual_time = json.flag("virtual_time");
  json.finish();
  const auto path =
      experimentPath(listExperiments(folders_.experiments, folders_.own), selection.file);
  if (!path) return refusal(404, notListed(selection.file));
  const std::lock_guard lock(mutex_);
  if (run_ && !run_->code()) {
    return refusal(409, "the run that was started here has not ended; wait, or end it on its page");
  }
  run_.reset();
  const fs::path folder = DetachedCommand::makeFolder();
  std::vector<std::string> arguments = selection.arguments(folders_.programs, "run", *path);
  arguments.push_back("--out=" + folders_.runs.string());
  if (virtual_time) {
    arguments.emplace_back("--virtual-time");
  } else {
    arguments.emplace_back("--web");
    arguments.push_back("--web-address-file=" + (folder / kAddress).string());
  }
  run_ = std::make_unique<DetachedCommand>(folder, arguments);
  return {202, "{}"};
}

std::string RunLauncher::started(bool control) {
  const std::lock_guard lock(mutex_);
  if (!run_) {
    return toText(
        Json{{"state", "none"}, {"code", {}}, {"output", ""}, {"address", {}}, {"run", {}}});
  }
  const std::optional<int> code = run_->code();
  const std::string output = withoutToken(run_->output());
  return toText(Json{{"state", code ? "ended" : "running"},
                     {"code", code ? Json(*code) : Json()},
                     {"output", output},
                     {"address", control ? addressIn(run_->folder() / kAddress) : Json()},
                     {"run", runOf(output)}});
}

}  // namespace lab::dashboard
