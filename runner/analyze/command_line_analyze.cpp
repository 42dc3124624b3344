#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "runner/analyze/analyze_commands.hpp"
#include "runner/command_line/command_line_parts.hpp"

namespace lab::runner {

void addAnalyze(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<AnalyzeOptions>();
  CLI::App* command = app.add_subcommand("analyze", summaryOf("analyze"));
  command
      ->add_option("RUN|FILE", options->input,
                   "Folder of a run, a log, a file of lab export (.mcap, .h5), or a file of "
                   "poses (docs/track.md)")
      ->required();
  command->add_option("--out", options->out, "Folder for the results (default: beside the input)");
  command->add_flag("--figures,!--no-figures", options->figures, "Draw the figures (default: yes)");
  command->add_flag("--bootstrap,!--no-bootstrap", options->bootstrap,
                    "Fit the exact laws, with intervals from simulated recordings (default: yes)");
  command->add_flag("--stitch,!--no-stitch", options->stitch,
                    "Join the motion before and after reversals (default: yes)");
  command
      ->add_option("--free", options->free_times,
                   "Durations that the fit frees, separated by commas: epsilon, tau_t (default: "
                   "as programmed)")
      ->delimiter(',')
      ->check(CLI::IsMember({"epsilon", "tau_t"}));
  CLI::Option* retrack =
      command->add_flag("--retrack", options->retrack,
                        "A run with a film: track it again, and analyze the new poses with the "
                        "old telemetry, in RUN/retracked");
  command
      ->add_option("--calibration", options->calibration,
                   "With --retrack: calibration of the camera (default: that of the run)")
      ->needs(retrack);
  command->add_option("--program", options->program,
                      "Poses: program of all robots, a shipped one (default: not known)");
  addSettings(*command, options->set,
              "Poses: parameter of the program, as v_cm_s=3; with --retrack: key of the "
              "experiment (repeatable)")
      ->type_name("NAME=VALUE");
  command
      ->add_option("--scale-cm", options->scale_cm,
                   "Poses: length in cm of one unit of columns x and y")
      ->check(between(1e-9, 1e9));
  command->add_option("--fps", options->fps, "Poses: frames per second, if the file has no times")
      ->check(between(1e-6, 1e6));
  command->callback([&chosen, options] { chosen = [options] { return analyze(*options); }; });
}

void addReportOfRun(CLI::App& app, Chosen& chosen) {
  auto directory = std::make_shared<std::filesystem::path>();
  CLI::App* command = app.add_subcommand(kReportOfRun, "")->group("");  // for `lab run` alone
  command->add_option("DIRECTORY", *directory)->required();
  command->callback(
      [&chosen, directory] { chosen = [directory] { return reportOfRun(*directory); }; });
}

void addTheory(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<TheoryOptions>();
  CLI::App* command = app.add_subcommand("theory", summaryOf("theory"));
  command->add_option("MODEL", options->program, "A program whose law is known in closed form")
      ->required();
  // "KEY=VALUE" as a name is refused by CLI11 from 2.3 on.
  command
      ->add_option("SETTING", options->set,
                   "Its keys as in experiment files (v_cm_s=3 epsilon_s=0.25 eta_rad_s=6), and "
                   "diameter_cm, the wheel base")
      ->type_name("KEY=VALUE");
  command->add_option("--lags", options->lags,
                      "Lags in s, separated by commas (default: 0.01 to 1000)");
  command
      ->add_option("--exposure-ms", options->exposure_ms,
                   "Exposure of a frame: positions are averaged over it")
      ->check(between(0, 60000));
  command->add_option("--noise-cm", options->noise_cm, "Localisation noise per axis")
      ->check(between(0, 100));
  command->add_option("--noise-deg", options->noise_deg, "Noise of the heading")
      ->check(between(0, 360));
  command->add_option("--phase-s", options->phase_s,
                      "Locked clocks: time from the begin of a window to the next draw");
  command
      ->add_option("--phases", options->phases,
                   "Locked clocks: number of phases of the hold on which frames fall, one of them "
                   "--phase-s before a draw (default: 1)")
      ->check(CLI::Range(1, 100000));
  command->add_option("--turning-deg", options->turning_deg,
                      "LOW,HIGH of the angles of turns between runs (default: -180,180)");
  command->add_flag("--kurtosis", options->kurtosis,
                    "Add a column with the kurtosis, where the law gives it");
  command->callback([&chosen, options] { chosen = [options] { return theory(*options); }; });
}

}  // namespace lab::runner
