#include "common/experiment/experiment_file.hpp"

#include <cstdint>
#include <system_error>
#include <utility>

#include "common/experiment/checks/camera_checks.hpp"
#include "common/experiment/checks/light_checks.hpp"
#include "common/experiment/checks/network_checks.hpp"
#include "common/experiment/checks/observable_checks.hpp"
#include "common/experiment/checks/robot_checks.hpp"
#include "common/experiment/checks/script_checks.hpp"
#include "common/experiment/keys/experiment_form.hpp"
#include "common/experiment/keys/experiment_keys.hpp"
#include "common/experiment/keys/toml_reader.hpp"
#include "common/files/file_problems.hpp"
#include "common/files/file_text.hpp"
#include "common/files/toml_document.hpp"
#include "common/programs/shipped_programs.hpp"

namespace lab {
namespace {

constexpr std::size_t kMostProblems = 20;
constexpr std::uintmax_t kMostBytes = file_kinds::kExperiment.most_bytes;
constexpr auto kUnknown = static_cast<std::uintmax_t>(-1);  // file_size() of no regular file

[[noreturn]] void refuse(const std::string& name, const std::string& why) {
  throw ExperimentError({name + ": " + why});
}

void refuseSize(const std::string& name, std::uintmax_t bytes) {
  if (bytes <= kMostBytes || bytes == kUnknown) return;
  refuse(name, "found " + std::to_string(bytes) + " bytes, allowed at most " +
                   std::to_string(kMostBytes) + ": is this an experiment file?");
}

std::string readFile(const std::filesystem::path& file) {
  const std::string name = file.string();
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) {
    refuse(name, "found no such file, allowed an experiment file (experiments/*.toml)");
  }
  if (std::filesystem::is_directory(status)) {
    refuse(name, "found a directory, allowed an experiment file in it");
  }
  refuseSize(name, std::filesystem::file_size(file, error));
  return readFileText(file, file_kinds::kExperiment);
}

void refuseOtherVersion(const keys::TomlDocument& document) {
  const toml::node* node = document.root().get("fileversion");
  if (node == nullptr) return;
  const auto version = node->value_exact<std::int64_t>();
  if (!version || *version == keys::kFileVersion) return;
  refuse(document.place(*node).text, "fileversion: found " + std::to_string(*version) +
                                         ", allowed only " + std::to_string(keys::kFileVersion) +
                                         " (another version of the lab wrote this file)");
}

void refuseProgram(const keys::TomlDocument& document, const std::string& name) {
  const toml::table& root = document.root();
  if (!root.contains("phases") || root.contains("fileversion")) return;
  refuse(name,
         "found a program of motion, allowed an experiment file; ./lab program check checks "
         "it, and an experiment uses it as model = \"" +
             std::filesystem::path(name).filename().string() + "\" in [programs.NAME]");
}

/// The lags that the file asks for. Programs are read before these keys are checked.
LagRange lagsOf(const toml::table& root) {
  const Experiment usual;
  const double fps = root["camera"]["fps"].value_or(usual.camera.fps);
  const double longest = root["analysis"]["max_lag_s"].value_or(usual.analysis.max_lag);
  LagRange lags;
  if (fps > 0) lags.shortest = 1 / fps;
  if (longest > lags.shortest) lags.longest = longest;
  return lags;
}

LawCheck lawCheck(const LawKnowledge& laws, const keys::TomlDocument& document) {
  if (!laws.problems) return {};
  return [&laws, lags = lagsOf(document.root())](const auto& text, const auto& compiled) {
    return laws.problems(text, compiled, lags);
  };
}

/// A shipped program, or a file beside the experiment file.
ModelLookup modelsBeside(const std::optional<std::filesystem::path>& directory,
                         const LawCheck& check_law) {
  return [directory, check_law](const std::string& model) -> std::optional<language::ProgramText> {
    if (!model.ends_with(".toml")) return shippedProgramText(model);
    if (!directory) return std::nullopt;
    const std::filesystem::path file = *directory / model;
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) return std::nullopt;
    return readProgram(readFileText(file, file_kinds::kProgram), file.string(),
                       file.stem().string(), kWidestWheels, check_law)
        .text;
  };
}

}  // namespace

Experiment loadExperiment(const std::filesystem::path& file,
                          const std::vector<std::string>& overrides, const LawKnowledge& laws) {
  return parseExperiment(readFile(file), file.string(), overrides, file.parent_path(), laws);
}

Experiment loadRecordedExperiment(const std::filesystem::path& file) {
  return parseExperiment(readFile(file), file.string());
}

Experiment parseExperiment(std::string_view text, const std::string& name,
                           const std::vector<std::string>& overrides,
                           const std::optional<std::filesystem::path>& directory,
                           const LawKnowledge& laws) {
  refuseSize(name, text.size());
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) {
    refuse(name, "found an empty file, allowed an experiment (docs/experiments.md)");
  }
  const keys::TomlDocument document(text, name, overrides);
  refuseOtherVersion(document);
  refuseProgram(document, name);
  keys::Problems problems([&](const std::string& path) { return document.place(path); });
  const LawCheck check_law = lawCheck(laws, document);
  keys::ExperimentForm form =
      keys::readForm(document, modelsBeside(directory, check_law), check_law, problems);
  form.recorded = !directory;
  keys::checkShorthand(form, problems);
  keys::expandShorthand(form);
  keys::checkRobots(form, problems);
  keys::checkCamera(form, directory, problems);
  keys::checkLight(form, directory, laws, problems);
  keys::checkRegions(form, problems);
  keys::checkTwins(form, problems);
  keys::checkStopRules(form, laws, problems);
  keys::checkNetworks(form, directory, problems);
  if (!problems.empty()) throw ExperimentError(problems.lines(kMostProblems));
  return keys::toExperiment(form);
}

}  // namespace lab
