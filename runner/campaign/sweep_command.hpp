/// `lab sweep`: campaigns.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "runner/campaign/campaign.hpp"
#include "runner/command_line/command_main.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner::campaign {

struct SweepOptions {
  std::filesystem::path input;  ///< an experiment file, or the folder of a campaign
  std::optional<std::filesystem::path> out;
  std::filesystem::path campaigns = "campaigns";  ///< where folders of campaigns are made
  bool fresh = false;  ///< begin a new campaign although the same one exists
  // What is asked; what is not given is taken from the table [sweep].
  std::vector<std::string> set;
  std::vector<std::string> over;
  std::optional<bool> zip;
  std::optional<std::int64_t> seeds;
  std::optional<std::int64_t> random;
  std::string sampling;  ///< "latin", "sobol"; empty: not given
  std::optional<std::uint64_t> seed;
  bool common_seeds = false;
  std::string keep;  ///< empty: summary
  bool fits = false;
  bool adaptive = false;  ///< of the grid, only the runs that the table [sweep.adaptive] asks for
  // How it is run.
  std::string engine = "local";
  int jobs = 0;                     ///< runs at a time; 0: one per core
  int bundle = 0;                   ///< runs per job of an engine; 0: about a minute of them
  std::string slurm;                ///< further options of sbatch
  std::string hosts;                ///< separated by commas, for parallel
  std::filesystem::path lab_there;  ///< the program on other hosts; empty: the same path as here
  bool wait = true;                 ///< until the jobs of the engine have ended
  bool retry = false;               ///< try failed runs again
  bool redo_stale = false;
  bool no_run = false;  ///< tables and page only
  std::vector<std::string> show;
  bool figures = true;
  // On a real lab.
  bool live = false;
  bool rehearse = false;           ///< play the live campaign in virtual time
  double rest_s = 0;               ///< robots stand between two runs [s]
  std::filesystem::path clear;     ///< experiment that clears the arena; empty: none
  std::int64_t tries = 3;          ///< of a marked run
  std::int64_t strikes = 2;        ///< until a robot is left out
  std::string until;               ///< "07:30"; empty: no limit
  std::vector<std::string> known;  ///< "D_r_rad2_s=2%"
  bool take_back = false;          ///< robots that were left out take part again
  // A worker of another engine.
  std::string rows;                   ///< "0-9,12": run these rows only, without tables
  std::filesystem::path bundle_file;  ///< where their results are written too; empty: nowhere
  bool code = false;                  ///< print the version that decides the identities
};

ExitCode sweep(const SweepOptions& options);

void addSweep(CLI::App& app, Chosen& chosen);

}  // namespace lab::runner::campaign
