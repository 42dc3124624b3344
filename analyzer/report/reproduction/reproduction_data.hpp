/// Data of the recordings of the paper's programs, for its figures.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analyzer/laws/paper_figures.hpp"
#include "analyzer/service/program_analysis.hpp"

namespace lab::report {

/// A point of the stitched track.
struct PathPoint {
  double t = 0;  ///< [s] of free motion
  double x = 0;  ///< [cm]
  double y = 0;  ///< [cm]
};

struct SpeedPoint {
  double t = 0;      ///< [s] of free motion
  double speed = 0;  ///< [cm/s]
};

/// <n(0) . n(l)> of the heading n along the path.
struct CorrelationPoint {
  double length = 0;  ///< l [cm]
  double value = 0;
  double sigma = 0;
};

/// One recording of one program.
struct RecordingData {
  analysis::ProgramResult result;
  std::vector<std::string> faults;  ///< faults of the run
  std::vector<PathPoint> path;      ///< the complete recording, thinned
  std::vector<PathPoint> close_up;  ///< some seconds, every frame
  std::vector<CorrelationPoint> correlation;
  double fitted_length = 0;        ///< [cm] of exp(-l/L) fitted to the correlation
  double fitted_length_sigma = 0;  ///< [cm]
  std::vector<SpeedPoint> speeds;
  std::vector<double> run_times;  ///< [s] run times of complete runs
};

/// The data to read from a recording besides its curves and estimates.
struct RecordingContents {
  bool path = false;
  bool correlation = false;
  bool runs = false;
};

/// The data of a set that the panels need.
[[nodiscard]] RecordingContents contentsFor(const std::vector<PaperPanel>& panels,
                                            const PaperSet& set);

/// Reads the run's log. @throws ReportError if the program is not in it.
[[nodiscard]] RecordingData readRecording(const std::filesystem::path& run,
                                          const RecordingContents& wants, analysis::Depth depth);

/// All recordings of one program: a single one, or an ensemble.
struct SetData {
  PaperSet set;
  std::vector<RecordingData> recordings;
};

}  // namespace lab::report
