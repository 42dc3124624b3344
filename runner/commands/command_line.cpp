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
  CLI::App* command = app.add_subcommand("run", "Run an experiment and make its report");
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
  CLI::App* command = app.add_subcommand("check", "Check an experiment file and describe the run");
  addExperiment(*command, *file);
  addSettings(*command, *set);
  command->callback([&chosen, file, set] { chosen = [=] { return check(*file, *set); }; });
}

void addReplay(CLI::App& app, Chosen& chosen, const fs::path& programs) {
  auto options = std::make_shared<ReplayOptions>();
  options->programs = programs;
  CLI::App* command = app.add_subcommand(
      "replay", "Play a recorded log on a separate LCM bus; the space bar pauses");
  command->add_option("LOG", options->log, "Log, or folder of a run")->required();
  command
      ->add_option("--from", options->from,
                   "Begin here: s since the log began, without what --max-gap leaves out")
      ->check(between(0, 1e9));
  command
      ->add_option("--to", options->to,
                   "End here: s since the log began, without what --max-gap leaves out")
      ->check(between(1e-3, 1e9));
  command->add_option("--speed", options->speed, "Seconds of the log per second")
      ->check(between(1e-3, 1e4))
      ->capture_default_str();
  command
      ->add_option("--max-gap", options->max_gap, "s to which longer gaps of the log are shortened")
      ->check(between(1e-3, 1e9))
      ->capture_default_str();
  command->add_flag("--loop", options->loop, "Start again at the end");
  command->add_option("--channel", options->channels, "Play only this channel (repeatable)")
      ->allow_extra_args(false);
  command->add_option("--port", options->port, "UDP port of the bus (default: a free one)")
      ->check(CLI::Range(1024, 65535));
  command->add_flag("--web", options->web, "Start the dashboard, which has a time slider");
  command->callback([&chosen, options] { chosen = [options] { return replay(*options); }; });
}

void addLight(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<LightOptions>();
  CLI::App* command = app.add_subcommand("light", "Set the light of a running lab");
  CLI::Option* layers = command->add_option(
      "LAYER", options->layers,
      "An intensity 0..1, or layers as in experiment files: "
      "'{kind = \"disk\", x_cm = 60, y_cm = 45, radius_cm = 20, intensity = 1}'");
  command->add_flag("--release", options->release, "Return to the light of the script")
      ->excludes(layers);
  command->add_option("--ramp", options->ramp, "Duration of the cross-fade in s")
      ->check(between(0, 3600));
  command
      ->add_option("--for", options->hold,
                   "Duration of this light in s; then the light of the script returns")
      ->check(between(1e-3, 1e9));
  command->add_option("--lab", options->lab, "Name of the lab; needed if several labs run");
  command->callback([&chosen, options] { chosen = [options] { return light(*options); }; });
}

void addStop(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<StopOptions>();
  CLI::App* command = app.add_subcommand("stop", "Stop every robot of every lab at once");
  command->add_flag("--clear", options->clear, "Release the stop: robots continue");
  command->add_option("--lab", options->lab, "Stop only this lab");
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
    {"pause", "Pause the light script; the present light stays, robots keep moving", pauseScript},
    {"resume", "Continue the script where it was paused", resumeScript},
    {"mark", "Write a remark into the record of the run", markRun, "TEXT", "The remark", true},
    {"end", "End the run as Ctrl-C does: data are kept, the report is made", endRun, "WHY",
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
  command->add_option("--lab", options->lab, "Name of the lab; needed if several labs run");
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
      "web", "The dashboard without a running lab: past runs, comparisons, starting experiments");
  command->add_option("--port", options->port, "First port tried (default: 8480)")
      ->check(CLI::Range(1024, 65535));
  addRunsFolder(*command, options->runs, "Folder of past and new runs");
  command->add_flag("--open", options->open, "Open the dashboard in your browser");
  command->callback([&chosen, options] { chosen = [options] { return web(*options); }; });
}

void addFlash(CLI::App& app, Chosen& chosen, const fs::path& programs) {
  auto options = std::make_shared<FlashOptions>();
  options->programs = programs;
  CLI::App* command = app.add_subcommand("flash", "Write the firmware to a robot");
  command->add_option("--port", options->port, "The robot's serial line, as /dev/serial/by-id/...")
      ->required();
  command->add_option("--baud", options->baud, "Speed of the robot's bootloader")
      ->capture_default_str();
  CLI::Option* isp = command->add_option(
      "--isp", options->isp,
      "Programmer as avrdude names it (usbasp, avrisp2): needs no bootloader, also sets the fuses");
  command
      ->add_option("--isp-port", options->isp_port, "Serial port of the programmer, if it has one")
      ->needs(isp);
  command->add_option("--robot-baud", options->robot_baud, "Speed of the robot's program")
      ->capture_default_str();
  command->add_option("--firmware", options->firmware, "Another .hex file")
      ->check(CLI::ExistingFile);
  command->callback([&chosen, options] { chosen = [options] { return flash(*options); }; });
}

void addSpy(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<SpyOptions>();
  CLI::App* command =
      app.add_subcommand("spy", "Show the channels of a running lab: rates, ages, lost messages");
  command->add_option("--lab", options->lab, "Name of the lab; needed if several labs run");
  command->add_option("--lcm-url", options->url, "URL of a bus, instead of a lab");
  command->add_option("--seconds", options->seconds, "End after this time in s")
      ->check(between(1e-3, 1e9));
  command->callback([&chosen, options] { chosen = [options] { return spy(*options); }; });
}

void addPython(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<PythonOptions>();
  CLI::App* command = app.add_subcommand(
      "python",
      "Python with the package active_lab: SCRIPT ARGUMENTS..., or an interactive session");
  command->add_flag("--where", options->where, "Print the folder of the package, for PYTHONPATH");
  command->prefix_command();
  command->callback([&chosen, options, command] {
    options->arguments = command->remaining();
    chosen = [options]() -> int { return python(*options); };
  });
}

/// Started by ssh on other hosts, and hidden in --help.
void addHostAgent(CLI::App& app, Chosen& chosen, const fs::path& programs) {
  CLI::App* command = app.add_subcommand("host-agent", "")->group("");
  command->callback([&chosen, programs] { chosen = [programs] { return hostAgent(programs); }; });
}

/// Commands of the script `./lab` at the root of a clone: says so to those who look for them here.
void addCloneOnly(CLI::App& app, Chosen& chosen) {
  for (const char* name : {"test", "package", "build"}) {
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
    for (const char* name : {"preview", "calibrate", "analyze", "export", "sweep", "queue", "twin",
                             "program", "theory", "track", "reproduce"}) {
      addProgramCommand(app, name);
    }
    addReplay(app, chosen, here);
    addLight(app, chosen);
    addStop(app, chosen);
    addRequestCommands(app, chosen);
    addWeb(app, chosen, here);
    addFlash(app, chosen, installation().programs);
    addSpy(app, chosen);
    addPython(app, chosen);
    addProgramCommand(app, "doctor");
    addHostAgent(app, chosen, installation().programs);
    addProgramsOfRun(app, chosen);
    addCloneOnly(app, chosen);
  });
}

}  // namespace lab::runner
