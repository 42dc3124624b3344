#include <CLI/CLI.hpp>
#include <memory>

#include "runner/analyze/analyze_commands.hpp"
#include "runner/command_line/command_line_parts.hpp"

namespace lab::runner {

void addReproduce(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<ReproduceOptions>();
  CLI::App* command = app.add_subcommand("reproduce", summaryOf("reproduce"));
  command->add_option("--out", options->out, "Folder for the page, the panels and the runs")
      ->capture_default_str()
      ->check(folderOrNewName());
  command
      ->add_option("--hours", options->hours, "Length of each recording (4b,c: always 3 minutes)")
      ->check(between(0.005, 200))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "All random numbers derive from it")
      ->check(CLI::Range(0, 1'000'000'000))
      ->capture_default_str();
  command->add_option("--panels", options->panels, "Only these panels: 2b,3d or whole figures: 4");
  command
      ->add_option("--ensemble", options->ensemble,
                   "Recordings of each set: means with errors from their scatter, and no fits")
      ->check(CLI::Range(1, 999))
      ->capture_default_str();
  command
      ->add_option("--through", options->through,
                   "What drives the robots: sim, or firmware on simulated chips")
      ->check(CLI::IsMember({"sim", "firmware"}))
      ->capture_default_str();
  command->add_option("--jobs", options->jobs, "Recordings at a time (default: one per core)")
      ->check(CLI::Range(1, 256));
  command->add_flag("--bootstrap,!--no-bootstrap", options->bootstrap,
                    "Fit the exact laws, with intervals from simulated recordings (default: yes)");
  command->add_flag("--keep-logs", options->keep_logs,
                    "Keep the logs: 150 MB per hour of recording");
  command->add_flag("--force", options->force, "Replace an earlier reproduction in the folder");
  command->callback([&chosen, options] { chosen = [options] { return reproduce(*options); }; });
}

}  // namespace lab::runner

int main(int argc, char** argv) {
  return lab::runner::commandMain(argc, argv, lab::runner::addReproduce);
}
