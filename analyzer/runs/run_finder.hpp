#pragma once

#include <cstdint>
#include <vector>

#include "analyzer/laws.hpp"
#include "analyzer/runs/run_segmentation.hpp"
#include "analyzer/tracks/track_stitcher.hpp"

namespace lab::analysis {

/// A run found in the poses.
struct ObservedRun {
  double duration = 0;   ///< s; for a run that was cut off, the observed part.
  bool begun = false;    ///< Its beginning was observed.
  bool ended = false;    ///< Its end, a tumble, was observed.
  bool follows = false;  ///< Exactly one tumble lies between it and the previous run in the list.
  double turn = 0;       ///< Turn of the single tumble before it, rad; nan: unknown.
  int track = 0;         ///< Number of its gap-free track.
};

/// A mean with its error and scatter.
struct Measured {
  double value = 0;
  double sigma = 0;    ///< Standard error.
  double scatter = 0;  ///< Standard deviation of a single value.
  double count = 0;
};

/// All runs and tumbles of one robot in one program, from its poses.
struct FoundRuns {
  std::vector<ObservedRun> runs;  ///< Runs of at least `shortest`.
  double shortest = 0;            ///< Duration of the shortest detectable run, s.
  std::int64_t hidden = 0;    ///< Number of shorter runs, inferred from the durations of the stops.
  std::int64_t tumbles = 0;   ///< Tumbles whose beginning was observed.
  double observed = 0;        ///< s.
  std::int64_t segments = 0;  ///< Tracks without gaps; each is cut off at both ends.
  Measured speed;             ///< Speed of runs, m/s.
  Measured tumble;            ///< Duration of single tumbles, s.
  Measured turning_rate;      ///< Of runs, rad/s: 0 for straight ones, positive to the left.
  double sigma = 0;           ///< Tracker noise per axis, m.
  double frames_per_tumble = 0;
  bool resolved = false;  ///< The frame rate is sufficient; else there are no runs.
};

/// Finds the runs and tumbles of one robot in the samples of its stitched track. A tumble is a stop
/// of duration tau_t, a run is a straight line at speed v. Both are measured; the programmed values
/// only set the scales of the search.
///
/// - Frames are averaged in bins of a tenth of a tumble, which reduces the noise.
/// - The duration of a run is the distance between its two stops divided by the speed: more
/// accurate than a frame, and runs between two frames show as a step.
/// - Steps below 7 standard errors are not counted as runs (`shortest`). The number of tumbles in a
/// stop follows from its duration, so that undetectable runs are counted.
/// - Runs of a robot that circles (its wheels differ) are arcs of one turning rate. It is measured,
///   and the search is for straight lines in a frame that turns at this rate.
/// - Removed reversals are bridged by the stitching; runs are cut off by gaps and ends of segments.
class RunFinder {
 public:
  RunFinder(const ProgramLaw& law, double frame_period);

  void add(const Sample& sample);

  /// Takes about 50 ms for an hour of data. Bins are kept in memory: 3 MB per hour.
  [[nodiscard]] FoundRuns find() const;

 private:
  struct Track {
    std::size_t begin = 0;  ///< Index of its first bin.
    double first = 0;       ///< Free time of its first frame, s.
    double last = 0;        ///< Free time of its last frame, s.
  };

  RunsAndTurns programmed_;
  double period_ = 0;  ///< Frame period, s.
  int frames_per_bin_ = 1;
  std::vector<TrackBin> bins_;
  std::vector<Track> tracks_;
  int segment_ = -1;
  std::int64_t bin_ = 0;  ///< Number of the last bin, counted from the first frame of the track.
};

}  // namespace lab::analysis
