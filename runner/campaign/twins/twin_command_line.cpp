#include <CLI/CLI.hpp>
#include <memory>

#include "runner/campaign/twins/twin_command.hpp"
#include "runner/command_line/command_line_parts.hpp"

namespace lab::runner::campaign {

void addTwin(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<TwinOptions>();
  CLI::App* command = app.add_subcommand("twin", summaryOf("twin"));
  command->add_option("RUN", options->run, "Folder of a run, or a log")->required();
  command->add_option("--count", options->count, "Number of twins")
      ->check(CLI::Range(kFewestTwins, 10000))
      ->capture_default_str();
  command->add_option("--out", options->out, "Folder for the results (default: that of the log)")
      ->check(folderOrNewName());
  command->add_option("--jobs", options->jobs, "Twins at a time (default: one per core)")
      ->check(CLI::Range(1, 10000));
  command->add_flag("--figures,!--no-figures", options->figures, "Draw figures (default: yes)");
  command->callback(
      [&chosen, options] { chosen = [options] { return static_cast<int>(twin(*options)); }; });
}

}  // namespace lab::runner::campaign
