/// One gap-free track of a robot, segmented into runs and stops. Internal to
/// RunFinder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "analyzer/runs/run_finder.hpp"
#include "analyzer/runs/run_segmentation.hpp"

namespace lab::analysis::segmentation {

/// A mean position [m] and its number of frames.
struct Place {
  double x = 0;
  double y = 0;
  double frames = 0;
};

/// The time between two detected runs: one stop, or several with undetectable runs between them.
struct StopInterval {
  Place arrival;
  Place departure;
  std::size_t begin = 0;  ///< Bins.
  std::size_t end = 0;
  std::int64_t stops = 1;  ///< Stops found in it.
};

/// The scales of a robot, used to segment its tracks.
struct Scales {
  double speed = 0;       ///< m/s.
  double tumble = 0;      ///< s.
  double sigma = 0;       ///< Per frame, m.
  double period = 0;      ///< Of bins, s.
  double shortest = 0;    ///< Duration of the shortest detectable run, s.
  double rate = 0;        ///< Turning rate of runs that the bins are freed of, rad/s.
  bool averaged = false;  ///< Bins are means of several frames, so bins at edges are mixtures.

  /// Sets `shortest` from the noise of the mean position in a stop of one tumble, without the bins
  /// at its edges.
  void setShortest(double frame_period);
};

/// Sums over all tracks that determine the scales.
struct ScaleSums {
  double time2 = 0;  ///< Sum of squared times of runs about their means, s^2.
  double drift = 0;  ///< s m.
  double runs = 0;
  double noise2 = 0;  ///< Sum of squares within stops, m^2.
  double freedom = 0;
  std::vector<double> tumbles;  ///< s.
  double bend = 0;              ///< Sum of the turning rates of runs by weight, rad s^3.
  double bend_weight = 0;       ///< s^4.
  double bent_runs = 0;

  /// @param sigma per frame, m
  [[nodiscard]] Measured speed(double sigma) const;

  /// The mean turning rate in runs, rad/s.
  /// @param sigma per frame, m
  /// @param speed m/s
  [[nodiscard]] Measured turningRate(double sigma, double speed) const;

  /// The duration of single tumbles, without double ones and parts of one.
  [[nodiscard]] Measured tumble() const;
};

/// One track, segmented into detected runs and the stops between them.
class SegmentedTrack {
 public:
  /// @param first,last free times of its first and last frame, s
  SegmentedTrack(std::span<const TrackBin> bins, double first, double last, const Scales& scales);

  /// Merges stops whose distance is too short for a run, by the current scales.
  void mergeStops();

  void measure(ScaleSums& sums) const;

  /// Adds the runs and tumbles of the track.
  void collect(FoundRuns& found) const;

 private:
  /// Adds the turning rate of a run: the angle between the directions of its halves over the time
  /// between their middles.
  void measureBend(const Stretch& core, ScaleSums& sums) const;

  /// The length of the run that ends at stop i, corrected for noise, m.
  [[nodiscard]] double runLength(std::size_t i) const;

  /// The bins of the run before stop i.
  [[nodiscard]] Stretch runBefore(std::size_t i) const;
  [[nodiscard]] Stretch runAfter(std::size_t i) const;

  [[nodiscard]] bool joined(const Stretch& run) const;

  /// Time of arrival at stop i, from the line of the run and the speed.
  /// @param rough true: by the nearest bins if the run is too short for a line.
  [[nodiscard]] std::optional<double> arrivalBy(std::size_t i, bool rough) const;
  [[nodiscard]] std::optional<double> departureBy(std::size_t i, bool rough) const;
  [[nodiscard]] std::optional<double> edge(const Stretch& run, const Place& place,
                                           const Place* other, double sign, bool rough,
                                           std::size_t bin) const;

  /// Number of tumbles that began during a stop. A tumble in progress at the beginning of the track
  /// does not count.
  [[nodiscard]] std::int64_t tumblesIn(double stood, bool cut_before, bool cut_behind) const;

  /// The turn of the single tumble in stop i, from the runs before and after it, rad; nan: unknown.
  [[nodiscard]] double turn(std::size_t i) const;

  std::span<const TrackBin> bins_;
  double first_;
  double last_;
  const Scales& scales_;
  std::vector<Stretch> stretches_;
  std::vector<StopInterval> stops_;
};

}  // namespace lab::analysis::segmentation
