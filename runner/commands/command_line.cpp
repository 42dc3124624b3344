#include "runner/commands/command_line.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "common/process/installation.hpp"
#include "runner/command_line/command_line_parts.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/commands/commands.hpp"
#include "runner/commands/run_command.hpp"
#include "runner/hosts/host_agent.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;

void addRun(CLI::App& app, Chosen& chosen, char** argv) {
  auto options = std::make_shared<RunOptions>();
  options->programs = installation().programs;
  CLI::App* command = app.add_subcommand("run", "Run an experiment: services, script, log, report");
  addRunOptions(*command, *options);
  command->callback([&chosen, options, argv] {
    chosen = [options, argv]() -> int {
      if (options->virtual_time) becomeProgram("lab-run-virtual", argv);
      return run(*options, {});
    };
  });
}

void addCheck(CLI::App& app, Chosen& chosen) {
  auto file = std::make_shared<fs::path>();
  auto set = std::make_shared<std::vector<std::string>>();
  CLI::App* command = app.add_subcommand("check", "Validate an experiment; say what would start");
  addExperiment(*command, *file);
  command->add_option("--set", *set, "key=value: instead of the file's (repeatable)")
      ->allow_extra_args(false);
  command->callback([&chosen, file, set] { chosen = [=] { return check(*file, *set); }; });
}

void addReplay(CLI::App& app, Chosen& chosen, const fs::path& programs) {
  auto options = std::make_shared<ReplayOptions>();
  options->programs = programs;
  CLI::App* command =
      app.add_subcommand("replay", "Play a log onto a bus of its own; space pauses");
  command->add_option("LOG", options->log, "Log, or folder of a run")->required();
  command->add_option("--from", options->from, "s since the log began")->check(between(0, 1e9));
  command->add_option("--to", options->to, "s since the log began")->check(between(1e-3, 1e9));
  command->add_option("--speed", options->speed, "Log seconds a second")
      ->check(between(1e-3, 1e4))
      ->capture_default_str();
  command->add_flag("--loop", options->loop, "Begin again at the end");
  command->add_option("--channel", options->channels, "Only these (repeatable)")
      ->allow_extra_args(false);
  command->add_option("--port", options->port, "UDP port of the bus (default: a free one)")
      ->check(CLI::Range(1024, 65535));
  command->add_flag("--web", options->web, "On a page in a browser, with a slider");
  command->callback([&chosen, options] { chosen = [options] { return replay(*options); }; });
}

void addLight(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<LightOptions>();
  CLI::App* command = app.add_subcommand("light", "Set the light of a running lab by hand");
  CLI::Option* layers = command->add_option(
      "LAYER", options->layers,
      "An intensity 0..1, or layers as in experiment files: "
      "'{kind = \"disk\", x_cm = 60, y_cm = 45, radius_cm = 20, intensity = 1}'");
  command->add_flag("--release", options->release, "Give the light back to the script")
      ->excludes(layers);
  command->add_option("--ramp", options->ramp, "s of cross-fade")->check(between(0, 3600));
  command->add_option("--for", options->hold, "s, then the script's light returns")
      ->check(between(1e-3, 1e9));
  command->add_option("--lab", options->lab, "Which lab, when several run");
  command->callback([&chosen, options] { chosen = [options] { return light(*options); }; });
}

void addStop(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<StopOptions>();
  CLI::App* command = app.add_subcommand("stop", "Every robot of every lab stops, now");
  command->add_flag("--clear", options->clear, "Release the stop: robots go on");
  command->add_option("--lab", options->lab, "Only this lab");
  command->callback([&chosen, options] { chosen = [options] { return stop(*options); }; });
}

/// A request to a running lab, with the name of its argument; nullptr: it takes none.
struct RequestCommand {
  const char* name;
  const char* summary;
  ExitCode (*send)(const RequestOptions&);
  const char* argument = nullptr;
  const char* argument_summary = nullptr;
  bool argument_required = false;
};

constexpr RequestCommand kRequests[] = {
    {"pause", "The script's clock stands; light and robots go on as they are", pauseScript},
    {"resume", "The script goes on where it was paused", resumeScript},
    {"mark", "Writes a remark into the run's record", markRun, "TEXT", "The remark", true},
    {"end", "Ends the run as Ctrl-C does: data kept, report written", endRun, "WHY",
     "Reason, for the record"},
};

void addRequest(CLI::App& app, Chosen& chosen, const RequestCommand& request) {
  auto options = std::make_shared<RequestOptions>();
  auto words = std::make_shared<std::vector<std::string>>();
  CLI::App* command = app.add_subcommand(request.name, request.summary);
  if (request.argument != nullptr) {
    command->add_option(request.argument, *words, request.argument_summary)
        ->required(request.argument_required);
  }
  command->add_option("--lab", options->lab, "Which lab, when several run");
  command->callback([&chosen, options, words, send = request.send] {
    options->text = fmt::format("{}", fmt::join(*words, " "));
    chosen = [options, send] { return send(*options); };
  });
}

void addRequestCommands(CLI::App& app, Chosen& chosen) {
  for (const RequestCommand& request : kRequests) addRequest(app, chosen, request);
}

void addWeb(CLI::App& app, Chosen& chosen, const fs::path& programs) {
  auto options = std::make_shared<WebOptions>();
  options->programs = programs;
  CLI::App* command = app.add_subcommand(
      "web", "The page in a browser without a lab: past runs, comparisons, starting an experiment");
  command->add_option("--port", options->port, "The first one tried (default: 8480)")
      ->check(CLI::Range(1024, 65535));
  command->add_option("--runs", options->runs, "Folder of past runs")->capture_default_str();
  command->add_flag("--open", options->open, "Show it in your browser");
  command->callback([&chosen, options] { chosen = [options] { return web(*options); }; });
}

void addFlash(CLI::App& app, Chosen& chosen, const fs::path& programs) {
  auto options = std::make_shared<FlashOptions>();
  options->programs = programs;
  CLI::App* command = app.add_subcommand("flash", "The firmware onto a robot");
  command->add_option("--port", options->port, "The robot's serial line, as /dev/serial/by-id/...")
      ->required();
  command->add_option("--baud", options->baud, "Speed of its bootloader")->capture_default_str();
  CLI::Option* isp = command->add_option(
      "--isp", options->isp,
      "Programmer as avrdude names it (usbasp, avrisp2): no bootloader, sets the fuses too");
  command->add_option("--isp-port", options->isp_port, "The programmer's line, if it has one")
      ->needs(isp);
  command->add_option("--robot-baud", options->robot_baud, "Speed of the robot's program")
      ->capture_default_str();
  command->add_option("--firmware", options->firmware, "Another .hex")->check(CLI::ExistingFile);
  command->callback([&chosen, options] { chosen = [options] { return flash(*options); }; });
}

void addSpy(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<SpyOptions>();
  CLI::App* command = app.add_subcommand("spy", "Channels of a running lab: rates, ages, gaps");
  command->add_option("--lab", options->lab, "Which lab, when several run");
  command->add_option("--lcm-url", options->url, "Any bus, instead of a lab's");
  command->add_option("--seconds", options->seconds, "End after this long")
      ->check(between(1e-3, 1e9));
  command->callback([&chosen, options] { chosen = [options] { return spy(*options); }; });
}

/// Started by ssh on other hosts, and hidden in --help.
void addHostAgent(CLI::App& app, Chosen& chosen, const fs::path& programs) {
  CLI::App* command = app.add_subcommand("host-agent", "")->group("");
  command->callback([&chosen, programs] { chosen = [programs] { return hostAgent(programs); }; });
}

/// Commands of the script `./lab` at the root of a clone: says so to those who look for them here.
void addCloneOnly(CLI::App& app, Chosen& chosen) {
  for (const char* name : {"test", "package"}) {
    CLI::App* command = app.add_subcommand(name, "")->group("")->prefix_command();
    command->callback([&chosen, name] {
      chosen = [name]() -> int {
        throw UserError(std::string(name) + " is for a clone of the source: ./lab " + name +
                        " in its folder");
      };
    });
  }
}

/// Prints what `./lab run` has to build, see programsOfRun().
void addProgramsOfRun(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = app.add_subcommand("programs-of-run", "")->group("");
  addRunOptions(*command, *options);
  command->callback([&chosen, options] {
    chosen = [options] {
      for (const std::string& program : programsOfRun(*options)) std::cout << program << "\n";
      return kDone;
    };
  });
}

/// A line in --help. Before it parses, runCommandLine() executes the program that has the command.
void addProgramCommand(CLI::App& app, const std::string& name) {
  app.add_subcommand(name, summaryOf(name))->prefix_command();
}

}  // namespace

int runCommandLine(int argc, char** argv) {
  if (argc > 1) {
    if (const ProgramCommand* command = findProgramCommand(argv[1])) {
      becomeProgram(command->program, argv);
    }
  }
  return runCommands(argc, argv, [argv](CLI::App& app, Chosen& chosen) {
    const fs::path here = fs::canonical("/proc/self/exe").parent_path();
    addRun(app, chosen, argv);
    addCheck(app, chosen);
    for (const char* name : {"preview", "calibrate", "analyze", "theory", "track", "reproduce"}) {
      addProgramCommand(app, name);
    }
    addReplay(app, chosen, here);
    addLight(app, chosen);
    addStop(app, chosen);
    addRequestCommands(app, chosen);
    addWeb(app, chosen, here);
    addFlash(app, chosen, installation().programs);
    addSpy(app, chosen);
    addProgramCommand(app, "doctor");
    addHostAgent(app, chosen, installation().programs);
    addProgramsOfRun(app, chosen);
    addCloneOnly(app, chosen);
  });
}

}  // namespace lab::runner
