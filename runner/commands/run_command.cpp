#include "runner/commands/run_command.hpp"

#include <fmt/format.h>
#include <signal.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "analyzer/law_knowledge.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/experiment/service_placement.hpp"
#include "common/process/child_process.hpp"
#include "common/process/installation.hpp"
#include "common/text/printable.hpp"
#include "runner/command_line/command_line_parts.hpp"
#include "runner/command_line/print_line.hpp"
#include "runner/live/dashboard_process.hpp"
#include "runner/live/progress_line.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

constexpr const char* kReporter = "lab-analyze";
constexpr const char* kReportOfRun = "report-of-run";  // its command, see analyze_commands.hpp
constexpr const char* kTwinMaker = "lab-twin";

std::vector<std::string> settingsOf(const RunOptions& options) {
  if (!options.seed) return options.set;
  return withOption(options.set, "--seed", "seed", std::to_string(*options.seed));
}

void requireMaker(const fs::path& programs, const char* maker, const char* what,
                  const char* way_out) {
  const fs::path file = programs / maker;
  if (fs::exists(file)) return;
  throw UserError(fmt::format("{} {}, which does not exist: {}; or leave {}", what, file.string(),
                              installation().installHint(maker, "./lab build builds it"), way_out));
}

/// What is made of the log after the run.
void requireMakers(const fs::path& programs, bool twins) {
  requireProgram("gnuplot", "gnuplot-nox");
  requireMaker(programs, kReporter, "the report needs", "the report out with --no-report");
  if (twins) {
    requireMaker(programs, kTwinMaker, "analysis.twins needs",
                 "them out with --set analysis.twins=0");
  }
}

/// Whether this process survives SIGTERM.
bool outlivesSigterm() {
  struct sigaction term {};
  return sigaction(SIGTERM, nullptr, &term) == 0 && term.sa_handler != SIG_DFL;
}

/// Lets another program write into the run's folder and print its headline here.
/// @param what for the messages: "report"
/// @return whether it has done so; if not, a line on stderr says why
bool make(const char* what, const fs::path& programs, const char* maker,
          std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), (programs / maker).string());
  ChildSettings settings{.arguments = std::move(arguments),
                         .input = ChildSettings::kInherited,
                         .output = ChildSettings::kInherited,
                         .errors = ChildSettings::kInherited,
                         .group = ChildSettings::Group::kShared,
                         // Who kills `lab run` ends these too.
                         .death_signal = SIGKILL};
  // A signal that this process survives must not end them either: exec keeps "ignored", but
  // resets handlers.
  if (outlivesSigterm()) settings.ignored_signals = {SIGTERM};
  try {
    ChildProcess reporter(settings);
    reporter.wait();
    if (const int signal = reporter.endingSignal()) {
      fmt::print(stderr, "lab: no {}: {} was killed by signal {}\n", what, maker, signal);
    }
    return reporter.code() == 0;
  } catch (const std::system_error& error) {
    fmt::print(stderr, "lab: no {}: {}\n", what, printable(error.what()));
    return false;
  }
}

}  // namespace

ExitCode run(const RunOptions& options, const RunVirtual& run_virtual) {
  const bool web = wantsDashboard(options.web, options.virtual_time, std::getenv("CI"));
  if (!web && !options.web_address.empty()) {
    throw UserError("--web-address-file " + options.web_address.string() +
                    ": this run has no dashboard; add --web (not with --virtual-time), or "
                    "leave it out");
  }
  const std::vector<std::string> set = settingsOf(options);
  Experiment experiment = loadExperiment(options.file, set, analysis::lawKnowledge());
  adopt(options.sources, experiment);
  std::optional<UserProgram> user_program;
  if (!options.with.empty()) user_program = findUserProgram(options.with);
  if (options.report) {
    requireMakers(options.programs, experiment.analysis.twins > 0);
  }
  if (options.virtual_time && experiment.gateway.ros) {
    fmt::print(stderr, "lab: a run in virtual time is not visible in ROS 2 (docs/ros2.md)\n");
  }
  const double duration = experiment.duration;
  const int twins = experiment.analysis.twins;
  double elapsed = 0;
  std::optional<ProgressLine> line(std::in_place, duration);
  const Launched launched =
      launch({.file = options.file,
              .out = options.out,
              .programs = options.programs,
              .set = options.set,
              .run_virtual = options.virtual_time ? run_virtual : RunVirtual(),
              .web = web,
              .web_address = options.web_address,
              .user_program = user_program,
              .threads = options.threads},
             std::move(experiment), [&](const Progress& progress) {
               elapsed = progress.elapsed;
               line->show(progress);
             });

  line.reset();
  const RunOutcome& outcome = launched.outcome;
  if (outcome.interrupted) {
    fmt::print("{} after {:.0f} s of {:.10g} s\n", printable(outcome.ended_because), elapsed,
               duration);
  }
  printFaults(outcome.faults);
  std::fflush(stdout);
  // The run is over and its log is kept. A report that cannot be made is a failure of its own.
  bool reported = true;
  if (options.report) {
    // A relative name that begins with - would be an option.
    const std::string directory = fs::absolute(launched.directory).string();
    reported = make("report", options.programs, kReporter, {kReportOfRun, directory});
    if (reported && twins > 0) {
      reported = make("twins", options.programs, kTwinMaker,
                      {"twin", directory, "--count", std::to_string(twins)});
    }
  }
  if (outcome.closed_early) return kClosedEarly;
  return reported ? kDone : kFailed;
}

std::vector<std::string> programsOfRun(const RunOptions& options) {
  const Experiment experiment =
      loadExperiment(options.file, settingsOf(options), analysis::lawKnowledge());
  std::vector<std::string> programs = neededPrograms(experiment, options.virtual_time);
  if (options.virtual_time) programs.emplace_back("lab-run-virtual");
  if (options.report) programs.emplace_back(kReporter);
  if (options.report && experiment.analysis.twins > 0) programs.emplace_back(kTwinMaker);
  if (wantsDashboard(options.web, options.virtual_time, std::getenv("CI"))) {
    programs.emplace_back(kObserverService);
  }
  return programs;
}

void addRunOptions(CLI::App& command, RunOptions& options) {
  addExperiment(command, options.file);
  command.add_flag(
      "--virtual-time", options.virtual_time,
      "Simulate in one process, as fast as possible; the same seed gives the same log");
  command.add_option("--seed", options.seed, "Replaces the seed of the file")->check(wholeNumber());
  command
      .add_option("--threads", options.threads,
                  "Threads of the simulator (default: one per processor); the results do not "
                  "depend on it")
      ->check(CLI::Range(1, 1024));
  addRunsFolder(command, options.out, "Folder for the folders of runs");
  addSettings(command, options.set);
  addSources(command, options.sources);
  command.add_option("--with", options.with,
                     "A program of yours that takes part: script.py, or \"script.py --gain 3\" "
                     "(docs/python.md)");
  command.add_flag("!--no-report", options.report,
                   "Keep the log only; lab analyze makes the report later");
  addChoice(command, "--web,!--no-web", options.web,
            "The dashboard in a browser (default: in real time, unless CI is set)");
  command.add_option("--web-address-file", options.web_address,
                     "File for the address of the dashboard, readable by you only");
}

}  // namespace lab::runner
