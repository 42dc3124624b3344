#include "runner/command_line/command_line_parts.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <system_error>
#include <utility>
#include <vector>

#include "common/command_line/parse_arguments.hpp"
#include "common/process/installation.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/command_line/experiment_lookup.hpp"

namespace lab::runner {
namespace {

/// Key and value of "key = value", without the spaces around them.
std::pair<std::string, std::string> splitSetting(const std::string& setting) {
  const std::size_t equals = setting.find('=');
  const std::string value = equals == std::string::npos ? "" : setting.substr(equals + 1);
  return {CLI::detail::trim_copy(setting.substr(0, equals)), CLI::detail::trim_copy(value)};
}

/// A text with quotes, as in a file, and without them, as on a command line, mean the same.
std::string withoutQuotes(const std::string& value) {
  const bool quoted = value.size() > 1 && value.front() == value.back() &&
                      (value.front() == '"' || value.front() == '\'');
  return quoted ? value.substr(1, value.size() - 2) : value;
}

}  // namespace

CLI::Validator between(double low, double high) {
  return {[low, high](const std::string& text) -> std::string {
            double value = 0;
            const bool number = CLI::detail::lexical_cast(text, value);
            if (number && value >= low && value <= high) return {};
            return fmt::format("found {}, allowed {:g} to {:g}", text, low, high);
          },
          "NUMBER"};
}

CLI::Validator wholeNumber() {
  return {[](const std::string& text) -> std::string {
            std::int64_t value = 0;
            const char* end = text.data() + text.size();
            const auto [rest, error] = std::from_chars(text.data(), end, value);
            if (error == std::errc{} && rest == end && value >= 0) return {};
            return fmt::format("found {}, allowed whole numbers from 0 to {}", text,
                               std::numeric_limits<std::int64_t>::max());
          },
          "NUMBER"};
}

void addChoice(CLI::App& command, const std::string& names, std::optional<bool>& choice,
               const std::string& text) {
  command.add_flag_function(
      names, [&choice](std::int64_t count) { choice = count > 0; }, text);
}

CLI::Option* addSettings(CLI::App& command, std::vector<std::string>& set,
                         const std::string& text) {
  const auto take = [&set](const std::vector<std::string>& given) {
    std::map<std::string, std::string> values;
    for (const std::string& setting : given) {
      const auto [key, value] = splitSetting(setting);
      const auto [known, is_new] = values.emplace(key, value);
      if (is_new || withoutQuotes(known->second) == withoutQuotes(value)) continue;
      throw UserError(fmt::format("--set {}={} and --set {}={}: two values for one key; keep one",
                                  key, known->second, key, value));
    }
    set = given;
  };
  return command.add_option_function<std::vector<std::string>>("--set", take, text)
      ->type_name(kSettingType)
      ->allow_extra_args(false);
}

bool hasSetting(const std::vector<std::string>& set, const std::string& key) {
  return std::any_of(set.begin(), set.end(), [&key](const std::string& setting) {
    return splitSetting(setting).first == key;
  });
}

void refuseContradiction(const std::vector<std::string>& set, const std::string& given,
                         const std::string& key, const std::string& value) {
  for (const std::string& setting : set) {
    const auto [set_key, set_value] = splitSetting(setting);
    if (set_key != key || withoutQuotes(set_value) == withoutQuotes(value)) continue;
    throw UserError(
        fmt::format("{} and --set {}={}: two values for one key; keep one", given, key, set_value));
  }
}

std::vector<std::string> withOption(std::vector<std::string> set, const std::string& option,
                                    const std::string& key, const std::string& value) {
  refuseContradiction(set, option + " " + value, key, value);
  set.push_back(key + "=" + value);
  return set;
}

CLI::Validator folderOrNewName() {
  return {[](const std::string& named) {
            std::error_code error;
            const auto status = std::filesystem::status(named, error);
            return !std::filesystem::exists(status) || std::filesystem::is_directory(status)
                       ? std::string()
                       : "found no folder at " + named + ", expected one or a new name";
          },
          ""};
}

void addRunsFolder(CLI::App& command, std::filesystem::path& runs, const std::string& text) {
  command.add_option("--runs,--out", runs, text)->capture_default_str()->check(folderOrNewName());
}

void addExperiment(CLI::App& command, std::filesystem::path& file) {
  command.add_option("FILE", file, "Experiment: a file (TOML), or the name of a shipped one")
      ->required()
      ->transform([](const std::string& named) {
        return findExperiment(named, installation().experiments).string();
      });
}

void addSources(CLI::App& command, CommandLineSources& sources) {
  command
      .add_option_function<std::string>(
          "--dds-configuration",
          [&sources](const std::string& file) {
            sources.dds_configuration = std::filesystem::absolute(file);
          },
          "Cyclone DDS configuration (XML) for ROS 2 instead of the lab's own; such a file can run "
          "code")
      ->type_name("FILE");
  command.add_option("--camera-pipeline", sources.camera_pipeline,
                     "GStreamer pipeline for experiments with camera = \"pipeline\": ELEMENT ! "
                     "ELEMENT ...; a pipeline can run code");
}

}  // namespace lab::runner
