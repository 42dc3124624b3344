#include "runner/command_line_parts.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdint>

#include "common/installation.hpp"
#include "runner/experiment_lookup.hpp"

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

}  // namespace lab::runner
