#pragma once

#include <cstdint>
#include <vector>

#include "analyzer/laws.hpp"
#include "analyzer/runs/run_segmentation.hpp"
#include "analyzer/tracks/track_stitcher.hpp"

namespace lab::analysis {

/// A run that the poses show.
struct ObservedRun {
  double duration = 0;   ///< s; of a run that was cut off, what was seen of it.
  bool begun = false;    ///< Its beginning was seen.
  bool ended = false;    ///< Its end was seen: a tumble.
  bool follows = false;  ///< One tumble after the run before it in the list.
  double turn = 0;       ///< Of the single tumble before it, rad; nan: not known.
  int track = 0;         ///< Which gap-free track it is from.
};

/// A mean over many, and its scatter.
struct Measured {
  double value = 0;
  double sigma = 0;    ///< Standard error.
  double scatter = 0;  ///< Of one.
  double count = 0;
};

/// All runs and tumbles of one robot in one program, from its poses.
struct FoundRuns {
  std::vector<ObservedRun> runs;  ///< Those of at least shortest.
  double shortest = 0;            ///< The shortest run that is told from none, s.
  std::int64_t hidden = 0;        ///< Shorter ones, known by how long the robot stood.
  std::int64_t tumbles = 0;       ///< Begun in view.
  double observed = 0;            ///< s.
  std::int64_t segments = 0;      ///< Tracks without a gap, each cut off at both ends.
  Measured speed;                 ///< Of runs, m/s.
  Measured tumble;                ///< Duration of single tumbles, s.
  double sigma = 0;               ///< Tracker noise per axis, m.
  double frames_per_tumble = 0;
  bool resolved = false;  ///< Whether poses come often enough; else there are no runs.
};

/// Finds the runs and tumbles of one robot in the samples of its stitched track. A tumble is a stop
/// of the duration tau_t, a run a straight line at v; both durations are measured, the programmed
/// ones only say on which scale to look.
///
/// - Bins of a tenth of a tumble are averaged, so that what noise hides in one frame is seen.
/// - A run's duration is the distance between the places of the two stops over the speed: it is
///   known far better than to a frame, and a run that no frame saw shows as a step.
/// - A step below 7 of its standard errors is taken for none (`shortest`). How many tumbles a stop
///   holds is known by its duration, so that runs too short to be seen are counted.
/// - Removed reversals are bridged by the stitching; gaps and ends of segments cut off runs.
class RunFinder {
 public:
  RunFinder(const ProgramLaw& law, double frame_period);

  void add(const Sample& sample);

  /// About 50 ms for an hour. Bins are kept until then: 3 MB an hour.
  [[nodiscard]] FoundRuns find() const;

 private:
  struct Track {
    std::size_t begin = 0;  ///< Of its bins.
    double first = 0;       ///< Free time of its first frame, s.
    double last = 0;        ///< Of its last frame.
  };

  ProgramLaw law_;
  double period_ = 0;  ///< Of frames.
  int frames_per_bin_ = 1;
  std::vector<TrackBin> bins_;
  std::vector<Track> tracks_;
  int segment_ = -1;
  std::int64_t bin_ = 0;  ///< Number of the last bin since the track's first frame.
};

}  // namespace lab::analysis
