#include "dashboard/library/run_launcher.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "dashboard/control/json_object_reader.hpp"
#include "dashboard/library/experiment_list.hpp"

namespace lab::dashboard {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostSettings = 64;
constexpr std::size_t kLongestText = 1000;  // bytes
constexpr std::chrono::seconds kCheckPatience{20};
constexpr const char* kAddress = "address.txt";

std::string dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

RunLauncher::Answer refusal(int status, const std::string& why) {
  return {status, dump(Json{{"error", why}})};
}

/// What the user wants to start.
struct Order {
  std::string file;
  std::vector<std::string> set;

  explicit Order(JsonObjectReader& form)
      : file(form.text("file", kLongestText)), set(form.texts("set", kMostSettings, kLongestText)) {
    for (const std::string& one : set) {
      if (one.find('=') == std::string::npos || one.starts_with('=')) {
        throw JsonObjectError(fmt::format("set: found \"{}\", expected key=value", one));
      }
    }
  }

  /// `lab` COMMAND and what was ordered.
  [[nodiscard]] std::vector<std::string> arguments(const fs::path& programs, const char* command,
                                                   const fs::path& path) const {
    std::vector<std::string> all{(programs / "lab").string(), command, path.string()};
    for (const std::string& one : set) all.push_back("--set=" + one);
    return all;
  }
};

std::string unlisted(const std::string& file) {
  return fmt::format("file: found \"{}\", expected one of GET /api/experiments", file);
}

/// The name of the run's folder, from the line "run      FOLDER"; null: not said yet.
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

/// Null: not written yet.
Json addressIn(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  if (!std::getline(stream, line) || !line.starts_with("http://")) return {};
  return line;
}

/// The output may be read by who must not have the token.
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
  return experimentsJson(listExperiments(places_.experiments, places_.own));
}

RunLauncher::Answer RunLauncher::check(std::string_view body) {
  JsonObjectReader form(body);
  const Order order(form);
  form.finish();
  const auto path = experimentPath(listExperiments(places_.experiments, places_.own), order.file);
  if (!path) return refusal(404, unlisted(order.file));
  const std::lock_guard lock(checking_);
  const CommandResult result =
      runCommand(order.arguments(places_.programs, "check", *path), kCheckPatience, closing_);
  const std::string late = result.late ? "stopped: it took longer than 20 s\n" : "";
  return {200, dump(Json{{"ok", result.code == 0}, {"text", result.output + late}})};
}

RunLauncher::Answer RunLauncher::start(std::string_view body) {
  JsonObjectReader form(body);
  const Order order(form);
  const bool virtual_time = form.flag("virtual_time");
  form.finish();
  const auto path = experimentPath(listExperiments(places_.experiments, places_.own), order.file);
  if (!path) return refusal(404, unlisted(order.file));
  const std::lock_guard lock(mutex_);
  if (run_ && !run_->code()) {
    return refusal(409, "a run that was started here has not ended; wait, or end it on its page");
  }
  run_.reset();
  const fs::path folder = DetachedCommand::makeFolder();
  std::vector<std::string> arguments = order.arguments(places_.programs, "run", *path);
  arguments.push_back("--out=" + places_.runs.string());
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
    return dump(
        Json{{"state", "none"}, {"code", {}}, {"output", ""}, {"address", {}}, {"run", {}}});
  }
  const std::optional<int> code = run_->code();
  const std::string output = withoutToken(run_->output());
  return dump(Json{{"state", code ? "ended" : "running"},
                   {"code", code ? Json(*code) : Json()},
                   {"output", output},
                   {"address", control ? addressIn(run_->folder() / kAddress) : Json()},
                   {"run", runOf(output)}});
}

}  // namespace lab::dashboard
