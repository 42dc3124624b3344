#include "runner/command_line/command_line_parts.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdint>
#include <limits>
#include <system_error>
#include <vector>

#include "common/process/installation.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/command_line/experiment_lookup.hpp"

namespace lab::runner {

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

void requireCommand(const CLI::App& app) {
  const CLI::App* at = &app;
  std::string typed;
  while (!at->get_subcommands().empty()) {
    at = at->get_subcommands().front();
    typed += at->get_name() + " ";
  }
  if (at->get_require_subcommand_min() == 0) return;
  std::string known;
  for (const CLI::App* command : at->get_subcommands([](const CLI::App* each) {
         return !each->get_group().empty();  // hidden commands have no group
       })) {
    known += (known.empty() ? "" : ", ") + command->get_name();
  }
  const std::vector<std::string> rest = app.remaining(true);
  throw UserError(fmt::format("{}found {}, expected one of {}; lab {}--help says what each does",
                              typed.empty() ? "" : typed.substr(0, typed.size() - 1) + ": ",
                              rest.empty() ? "no command" : "\"" + rest.front() + "\"", known,
                              typed));
}

void addChoice(CLI::App& command, const std::string& names, std::optional<bool>& choice,
               const std::string& text) {
  command.add_flag_function(
      names, [&choice](std::int64_t count) { choice = count > 0; }, text);
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
          "Cyclone DDS configuration (XML) for ROS 2 instead of the lab's own; it can run code")
      ->type_name("FILE");
  command.add_option("--camera-pipeline", sources.camera_pipeline,
                     "GStreamer pipeline of camera = \"pipeline\": ELEMENT ! ELEMENT ...; it can "
                     "run code");
}

}  // namespace lab::runner
