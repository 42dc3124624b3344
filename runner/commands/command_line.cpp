#include "runner/commands/command_line.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <iterator>

#include "common/experiment/experiment_file.hpp"
#include "common/process/installation.hpp"
#include "runner/command_line/build_facts.hpp"
#include "runner/command_line/command_line_parts.hpp"
#include "runner/command_line/experiment_lookup.hpp"
#include "runner/commands/commands.hpp"
#include "runner/doctor/doctor.hpp"
#include "runner/doctor/doctor_dds.hpp"
#include "runner/doctor/doctor_hosts.hpp"
#include "runner/hosts/host_agent.hpp"
#include "runner/runs/lab_registry.hpp"
#include "runner/runs/network.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;

/// Each adds one subcommand. CLI11 fills the options in while parsing; `chosen` is called after it.
void addRun(CLI::App& app, Chosen& chosen, const fs::path& programs) {
  auto options = std::make_shared<RunOptions>();
  options->programs = programs;
  CLI::App* command = app.add_subcommand("run", "Run an experiment: services, script, log, report");
  addExperiment(*command, options->file);
  command->add_flag("--virtual-time", options->virtual_time,
                    "One process, as fast as the machine allows, the same to the bit");
  command->add_option("--seed", options->seed, "Instead of the file's seed")->check(wholeNumber());
  command->add_option("--out", options->out, "Where run folders are made")->capture_default_str();
  command->add_option("--set", options->set, "key=value: instead of the file's (repeatable)")
      ->allow_extra_args(false);
  command->add_flag("!--no-report", options->report, "Keep the log, analyse later");
  addChoice(*command, "--web,!--no-web", options->web,
            "A page in a browser (default: in real time, where CI is not set)");
  command->add_option("--web-address-file", options->web_address,
                      "Where the page's address is written too, for you alone");
  command->callback([&chosen, options] { chosen = [options] { return run(*options); }; });
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

void addPreview(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<PreviewOptions>();
  CLI::App* command =
      app.add_subcommand("preview", "The light script as pictures, without running anything");
  addExperiment(*command, options->file);
  command->add_option("--out", options->out, "Folder for NAME_light.png and NAME_light.mp4")
      ->capture_default_str();
  command->add_option("--set", options->set, "key=value: instead of the file's (repeatable)")
      ->allow_extra_args(false);
  command->callback([&chosen, options] { chosen = [options] { return preview(*options); }; });
}

void addAnalyze(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<AnalyzeOptions>();
  CLI::App* command = app.add_subcommand(
      "analyze", "Summary, report, trajectories, figures from a log or a file of poses");
  command
      ->add_option("RUN|LOG|POSES.csv", options->input,
                   "Folder of a run, a log, or a file of poses (docs/track.md)")
      ->required();
  command->add_option("--out", options->out, "Folder for the results (default: beside the input)");
  command->add_flag("--figures,!--no-figures", options->figures, "Draw the figures (default: yes)");
  command->add_flag("--bootstrap,!--no-bootstrap", options->bootstrap,
                    "Fit the exact laws, with intervals from simulated films (default: yes)");
  command->add_flag("--stitch,!--no-stitch", options->stitch,
                    "Join the motion around reversals; else they cut (default: yes)");
  command->add_option("--program", options->program,
                      "Poses: what all robots ran: abp, noisy_abp, bp, rtp (default: not known)");
  command
      ->add_option("--set", options->set, "Poses: key=value of the program, v_cm_s=3 (repeatable)")
      ->allow_extra_args(false);
  command->add_option("--scale-cm", options->scale_cm, "Poses: one unit of columns x and y in cm")
      ->check(between(1e-9, 1e9));
  command->add_option("--fps", options->fps, "Poses: frames a second, where there are no times")
      ->check(between(1e-6, 1e6));
  command->callback([&chosen, options] { chosen = [options] { return analyze(*options); }; });
}

void addTheory(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<TheoryOptions>();
  CLI::App* command = app.add_subcommand(
      "theory", "The exact laws of a program as CSV, beside the paper's formula");
  command->add_option("PROGRAM", options->program, "abp, noisy_abp, bp, rtp")->required();
  command->add_option("KEY=VALUE", options->set,
                      "Its keys as in experiment files (v_cm_s=3 epsilon_s=0.25 eta_rad_s=6), and "
                      "diameter_cm, the wheel base");
  command->add_option("--lags", options->lags, "s, separated by commas (default: 0.01 to 1000)");
  command->add_option("--exposure-ms", options->exposure_ms, "Of a frame: positions are means")
      ->check(between(0, 60000));
  command->add_option("--noise-cm", options->noise_cm, "Localisation noise per axis")
      ->check(between(0, 100));
  command->add_option("--noise-deg", options->noise_deg, "Noise of the heading")
      ->check(between(0, 360));
  command->add_option("--phase-s", options->phase_s,
                      "Locked clocks: from a window's begin to the next draw");
  command
      ->add_option("--phases", options->phases,
                   "Locked clocks: frames fall on so many phases of the hold, one of them "
                   "--phase-s before a draw (default: at one)")
      ->check(CLI::Range(1, 100000));
  command->add_option("--turning-deg", options->turning_deg,
                      "LOW,HIGH of an rtp's turning angles (default: -180,180)");
  command->add_flag("--kurtosis", options->kurtosis, "One more column (bp)");
  command->callback([&chosen, options] { chosen = [options] { return theory(*options); }; });
}

void addTrack(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<TrackOptions>();
  CLI::App* command =
      app.add_subcommand("track", "Poses of all robots in a movie or in pictures, without a lab");
  command->add_option("SOURCE", options->source, "Movie, folder or pattern of pictures")
      ->required();
  command->add_option("--calibration", options->calibration, "Of the camera")->required();
  command->add_option("--out", options->out, "File of poses (CSV)")->required();
  command->add_option("--overlay", options->overlay,
                      "What was found and refused: NAME.png a contact sheet; .mp4, .mkv, .avi a "
                      "movie; else a folder of pictures");
  command->add_option("--every", options->every, "Only each so many-th frame")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  command
      ->add_option(
          "--fps", options->fps,
          "Frames a second: of pictures without frames.csv, and of a movie instead of its own")
      ->check(between(0.001, 100'000));
  command->add_option("--robots", options->robots, "How many there are: the best so many are taken")
      ->check(CLI::Range(1, 100'000));
  command->add_flag("--force", options->force, "Replace files that are there");
  command->callback([&chosen, options] { chosen = [options] { return track(*options); }; });
}

void addReproduce(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<ReproduceOptions>();
  CLI::App* command = app.add_subcommand(
      "reproduce", "Every panel of the paper's figures 2, 3, 4, in virtual time, on one page");
  command->add_option("--out", options->out, "Folder for the page, the panels and the runs")
      ->capture_default_str();
  command->add_option("--hours", options->hours, "Length of each film (4b,c: always 3 minutes)")
      ->check(between(0.005, 200))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "All random numbers derive from it")
      ->check(CLI::Range(0, 1'000'000'000))
      ->capture_default_str();
  command->add_option("--panels", options->panels, "Only these: 2b,3d or whole figures: 4");
  command
      ->add_option("--ensemble", options->ensemble,
                   "Films of each set: means with the errors of their scatter, and no fits")
      ->check(CLI::Range(1, 999))
      ->capture_default_str();
  command
      ->add_option("--through", options->through,
                   "What drives the robots: sim, or firmware on simulated chips")
      ->check(CLI::IsMember({"sim", "firmware"}))
      ->capture_default_str();
  command->add_option("--jobs", options->jobs, "Films at a time (default: one a core)")
      ->check(CLI::Range(1, 256));
  command->add_flag("--bootstrap,!--no-bootstrap", options->bootstrap,
                    "Fit the exact laws, with intervals from simulated films (default: yes)");
  command->add_flag("--keep-logs", options->keep_logs, "Keep the logs: 150 MB an hour of film");
  command->add_flag("--force", options->force, "Replace what is in the folder");
  command->callback([&chosen, options] { chosen = [options] { return reproduce(*options); }; });
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

void addDoctor(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<DoctorOptions>();
  CLI::App* command =
      app.add_subcommand("doctor", "What is wrong with this machine, and the line that fixes it");
  auto file = std::make_shared<std::string>();
  command->add_option("--out", options->runs, "Where run folders are made")->capture_default_str();
  command->add_option("FILE", *file, "Experiment: its hosts are visited too")
      ->transform([](const std::string& named) {
        return findExperiment(named, installation().experiments).string();
      });
  command->callback([&chosen, options, file] {
    chosen = [options, file] {
      constexpr int kListen_ms = 1200;  // whoever is there says so every second
      const Experiment experiment = file->empty() ? Experiment{} : loadExperiment(*file);
      options->registrations = registryDirectory();
      std::vector<Finding> findings = examine(*options);
      const auto add = [&findings](std::vector<Finding> more) {
        std::ranges::move(more, std::back_inserter(findings));
      };
      // DDS shares its ports with DDS, and with nobody else.
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

/// What ssh starts on other hosts: for programs, so no help speaks of it.
void addHostAgent(CLI::App& app, Chosen& chosen, const fs::path& programs) {
  CLI::App* command = app.add_subcommand("host-agent", "")->group("");
  command->callback([&chosen, programs] { chosen = [programs] { return hostAgent(programs); }; });
}

/// What only the script at the root of a clone does: whoever looks for it here is told so.
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

}  // namespace

int runCommandLine(int argc, char** argv) {
  CLI::App app{"Active Lab: active matter with light-driven robots, real or simulated",
               installation().command};
  app.set_version_flag("--version", buildFacts(), "Version, commit, compiler and libraries");
  app.require_subcommand(1);
  Chosen chosen;
  addRun(app, chosen, installation().programs);
  addCheck(app, chosen);
  addPreview(app, chosen);
  addCalibrate(app, chosen, installation().programs);
  addAnalyze(app, chosen);
  addTheory(app, chosen);
  addTrack(app, chosen);
  addReproduce(app, chosen);
  addReplay(app, chosen, fs::canonical("/proc/self/exe").parent_path());
  addLight(app, chosen);
  addStop(app, chosen);
  addRequestCommands(app, chosen);
  addWeb(app, chosen, fs::canonical("/proc/self/exe").parent_path());
  addFlash(app, chosen, installation().programs);
  addSpy(app, chosen);
  addDoctor(app, chosen);
  addHostAgent(app, chosen, installation().programs);
  addCloneOnly(app, chosen);
  try {
    app.parse(argc, argv);
  } catch (const CLI::RequiredError& error) {
    requireCommand(app);
    return app.exit(error) == 0 ? kDone : kBadInput;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kDone : kBadInput;
  }
  return chosen();
}

}  // namespace lab::runner
