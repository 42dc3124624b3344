/// The commands `analyze`, `theory` and `reproduce`. All throw UserError for what the user can
/// correct.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "runner/command_line/command_main.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner {

struct AnalyzeOptions {
  std::filesystem::path input;  ///< folder of a run, log, or file of poses (.csv)
  std::optional<std::filesystem::path> out;
  bool figures = true;
  bool stitch = true;     ///< join the motion around reversals
  bool bootstrap = true;  ///< fit the exact law; its intervals need simulated recordings
  std::vector<std::string> free_times = {};  ///< durations of the programs that the fit frees
  bool retrack = false;                      ///< a run with a film: track it again
  std::filesystem::path calibration;         ///< of the camera, for that; empty: that of the run
  /// For a file of poses only, and `set` also to track again, of the experiment:
  std::string program;             ///< model that all robots ran; empty: not known
  std::vector<std::string> set;    ///< key=value: its parameters
  std::optional<double> scale_cm;  ///< one unit of its columns x and y [cm]
  std::optional<double> fps;       ///< [1/s] if the file has no times
};
ExitCode analyze(const AnalyzeOptions& options);

/// Makes the report at the end of `lab run`, and prints its headline. The run is over: whatever
/// goes wrong is one line on stderr.
/// @return kFailed without a report
ExitCode reportOfRun(const std::filesystem::path& directory);

struct TheoryOptions {
  std::string program;            ///< whose law is known in closed form
  std::vector<std::string> set;   ///< key=value: its parameters, as in experiment files
  std::string lags;               ///< [s] separated by commas, empty: 0.01 to 1000
  double exposure_ms = 0;         ///< of a camera frame
  double noise_cm = 0;            ///< localisation noise per axis
  double noise_deg = 0;           ///< of the heading
  std::optional<double> phase_s;  ///< from the begin of a window to the next draw
  std::optional<int> phases;      ///< number of phases of the hold on which frames fall
  std::string turning_deg;        ///< LOW,HIGH of the angles of turns, empty: -180,180
  bool kurtosis = false;          ///< one more column
};
ExitCode theory(const TheoryOptions& options);

struct ReproduceOptions {
  std::filesystem::path out = "reproduction";
  double hours = 1;  ///< of each recording, except the short one of the paper
  std::uint64_t seed = 1;
  std::string panels;           ///< "2b,3d"; empty: all
  int ensemble = 1;             ///< recordings of each set
  std::string through = "sim";  ///< or "firmware": simulated chips
  int jobs = 0;                 ///< recordings at a time; 0: one per core
  bool bootstrap = true;        ///< fits of the exact law
  bool keep_logs = false;
  bool force = false;  ///< replace an earlier reproduction in the folder
};
ExitCode reproduce(const ReproduceOptions& options);

/// The hidden command behind reportOfRun().
inline constexpr const char* kReportOfRun = "report-of-run";

/// @name Their command lines
/// @{
void addAnalyze(CLI::App& app, Chosen& chosen);
void addReportOfRun(CLI::App& app, Chosen& chosen);
void addTheory(CLI::App& app, Chosen& chosen);
void addReproduce(CLI::App& app, Chosen& chosen);
/// @}

}  // namespace lab::runner
