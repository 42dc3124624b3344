#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "common/experiment/experiment_file.hpp"
#include "common/process/installation.hpp"
#include "runner/command_line/command_line_parts.hpp"
#include "runner/command_line/command_main.hpp"
#include "runner/command_line/experiment_lookup.hpp"
#include "runner/doctor/doctor.hpp"
#include "runner/doctor/doctor_dds.hpp"
#include "runner/doctor/doctor_hosts.hpp"
#include "runner/runs/lab_registry.hpp"
#include "runner/runs/network.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;

void addDoctor(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<DoctorOptions>();
  CLI::App* command = app.add_subcommand("doctor", summaryOf("doctor"));
  auto file = std::make_shared<std::string>();
  addRunsFolder(*command, options->runs, "Folder for the folders of runs");
  command->add_option("FILE", *file, "Experiment: its other hosts are checked too")
      ->transform([](const std::string& named) {
        return findExperiment(named, installation().experiments).string();
      });
  auto sources = std::make_shared<CommandLineSources>();
  addSources(*command, *sources);
  command->callback([&chosen, options, file, sources] {
    chosen = [options, file, sources] {
      constexpr int kListen_ms = 1200;  // participants announce themselves once per second
      Experiment experiment = file->empty() ? Experiment{} : loadExperiment(*file);
      adopt(*sources, experiment);
      options->registrations = registryDirectory();
      std::vector<Finding> findings = examine(*options);
      const auto add = [&findings](std::vector<Finding> more) {
        std::ranges::move(more, std::back_inserter(findings));
      };
      // DDS participants share ports with each other, LCM does not.
      add(judgePorts(
          experiment, [](int port) { return portIsFree(port); },
          [](int port) { return portIsFree(port, Sharing::kShared); }));
      add(judgeDds(surveyDds(experiment.gateway, fs::path(*file).parent_path(), kListen_ms)));
      add(examineHosts(experiment));
      print(std::cout, findings);
      return exitCode(findings);
    };
  });
}

}  // namespace
}  // namespace lab::runner

int main(int argc, char** argv) {
  return lab::runner::commandMain(argc, argv, lab::runner::addDoctor);
}
