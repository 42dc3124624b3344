#include <CLI/CLI.hpp>
#include <memory>

#include "runner/command_line/command_line_parts.hpp"
#include "runner/film/film_commands.hpp"

namespace lab::runner {

void addPreview(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<PreviewOptions>();
  CLI::App* command = app.add_subcommand("preview", summaryOf("preview"));
  addExperiment(*command, options->file);
  command->add_option("--out", options->out, "Folder for NAME_light.png and NAME_light.mp4")
      ->capture_default_str()
      ->check(folderOrNewName());
  addSettings(*command, options->set);
  command->callback([&chosen, options] { chosen = [options] { return preview(*options); }; });
}

}  // namespace lab::runner

int main(int argc, char** argv) {
  return lab::runner::commandMain(argc, argv, lab::runner::addPreview);
}
