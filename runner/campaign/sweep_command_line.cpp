#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "common/process/installation.hpp"
#include "runner/campaign/sweep_command.hpp"
#include "runner/command_line/command_line_parts.hpp"
#include "runner/command_line/experiment_lookup.hpp"

namespace lab::runner::campaign {

namespace {

void addLive(CLI::App& command, SweepOptions& options) {
  command.add_flag("--live", options.live,
                   "Play the runs on the real lab, one after another, in random order; marked runs "
                   "are repeated (default: simulate them)");
  command.add_flag("--rehearse", options.rehearse,
                   "With --live: the same in virtual time, to try a night before it");
  command.add_option("--rest", options.rest_s, "With --live: robots stand between two runs [s]")
      ->check(CLI::Range(0.0, 86400.0));
  command.add_option(
      "--clear", options.clear,
      "With --live: experiment that is played before each run, to spread the robots");
  command.add_option("--tries", options.tries, "With --live: of a run that is marked")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command
      .add_option(
          "--strikes", options.strikes,
          "With --live: a robot that stalls, vanishes or reboots in this many runs in a row "
          "is left out")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command.add_option("--until", options.until,
                     "With --live: no run ends later (07:30 or 2026-01-31T07:30, local time)");
  command
      .add_option(
          "--known", options.known,
          "With --live: a point has enough runs when the standard error of this estimate is "
          "at most PERCENT of its mean (repeatable)")
      ->type_name("QUANTITY=PERCENT")
      ->allow_extra_args(false);
  command.add_flag("--take-back", options.take_back,
                   "With --live: robots that were left out take part again");
}

}  // namespace

void addSweep(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<SweepOptions>();
  CLI::App* command = app.add_subcommand("sweep", summaryOf("sweep"));
  command
      ->add_option("FILE|CAMPAIGN", options->input,
                   "Experiment file, or name of a shipped experiment; or the folder of a campaign, "
                   "which is continued")
      ->required();
  command
      ->add_option("--over", options->over,
                   "KEY=1,2,3 or KEY=LOW:HIGH:COUNT[:log] or, with --random, KEY=LOW:HIGH "
                   "(repeatable; default: the table [sweep] of the file)")
      ->type_name("KEY=VALUES")
      ->allow_extra_args(false);
  addChoice(*command, "--zip,!--no-zip", options->zip,
            "The n-th values of all keys belong together (default: all combinations)");
  command->add_option("--seeds", options->seeds, "Runs per point, each with a seed of its own")
      ->check(CLI::Range(1, 100000));
  command->add_option("--random", options->random, "Draw this many points from the ranges")
      ->check(CLI::Range(1, 1000000));
  command->add_option("--sampling", options->sampling, "latin (hypercube) or sobol, for --random")
      ->check(CLI::IsMember({"latin", "sobol"}));
  command->add_option("--seed", options->seed, "Replaces the seed of the file, the base of all")
      ->check(wholeNumber());
  command->add_flag("--common-seeds", options->common_seeds,
                    "All points share their random numbers (default: independent ones)");
  addSettings(*command, options->set);
  command
      ->add_option("--keep", options->keep,
                   "What is kept of each run: logs (its folder as of lab run), summary (default), "
                   "nothing (its row of numbers)")
      ->check(CLI::IsMember({"logs", "summary", "nothing"}));
  command->add_flag("--fits", options->fits,
                    "Also fit the exact laws, by simulated recordings (slower)");
  command->add_flag(
      "--adaptive", options->adaptive,
      "Choose where to measure next: of the points and seeds, only the runs that tell "
      "most of what the table [sweep.adaptive] of the file asks (default: all runs)");
  command->add_option("--out", options->out, "Folder of the campaign (default: a new one)");
  command->add_option("--campaigns", options->campaigns, "Folder for the folders of campaigns")
      ->capture_default_str();
  command->add_flag("--new", options->fresh,
                    "Begin anew, although a campaign with the same request exists");
  command->add_option("--jobs", options->jobs, "Runs at a time (default: one per core)")
      ->check(CLI::Range(1, 10000));
  command
      ->add_option(
          "--engine", options->engine,
          "Where the runs are computed: local, slurm, parallel (GNU parallel over ssh), or "
          "only written out: snakemake, commands")
      ->check(CLI::IsMember({"local", "slurm", "parallel", "snakemake", "commands"}))
      ->capture_default_str();
  command
      ->add_option("--bundle", options->bundle,
                   "Runs per job of an engine (default: about a minute of them)")
      ->check(CLI::Range(1, 1000000));
  command->add_option("--slurm", options->slurm,
                      "Further options of sbatch, as \"--partition=short --mem=1G\"");
  command->add_option("--hosts", options->hosts,
                      "Hosts of the engine parallel, separated by commas; : is this machine");
  command->add_option("--lab-there", options->lab_there,
                      "The program lab on other hosts (default: the same path as here)");
  command->add_flag("!--no-wait", options->wait, "Return when the jobs are in the queue of Slurm");
  command->add_flag("--retry", options->retry, "Try failed runs again");
  command->add_flag("--redo-stale", options->redo_stale,
                    "Compute results of another version of the lab again");
  command->add_flag("--no-run", options->no_run, "Only make the tables and the page");
  command
      ->add_option("--show", options->show,
                   "Column of campaign.csv to draw, as D_r_rad2_s (repeatable; default: those that "
                   "vary most)")
      ->allow_extra_args(false);
  command->add_flag("--figures,!--no-figures", options->figures, "Draw figures (default: yes)");
  addLive(*command, *options);
  command->add_option("--rows", options->rows,
                      "Worker of a campaign: run these rows only (0-9,12), without tables");
  command->add_option("--bundle-file", options->bundle_file, "")->group("");
  command->add_flag("--code", options->code, "")->group("");
  command->callback([&chosen, options] {
    chosen = [options] {
      if (!std::filesystem::is_directory(options->input)) {
        options->input = findExperiment(options->input, installation().experiments);
      }
      if (!options->clear.empty()) {
        options->clear = findExperiment(options->clear, installation().experiments);
      }
      return static_cast<int>(sweep(*options));
    };
  });
}

}  // namespace lab::runner::campaign
