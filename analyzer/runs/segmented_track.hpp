/// One gap-free track of a tumbling robot, cut into runs and stops. Internal to the run finder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "analyzer/runs/run_finder.hpp"
#include "analyzer/runs/run_segmentation.hpp"

namespace lab::analysis::segmentation {

/// A mean place [m], of so many frames.
struct Place {
  double x = 0;
  double y = 0;
  double frames = 0;
};

/// The standing between two visible runs: one stop, or several with runs too short to be seen.
struct StopInterval {
  Place arrival;
  Place departure;
  std::size_t begin = 0;  ///< Bins.
  std::size_t end = 0;
  std::int64_t stops = 1;  ///< Found in it.
};

/// What is known of a robot while its tracks are cut.
struct Scales {
  double speed = 0;       ///< m/s.
  double tumble = 0;      ///< s.
  double sigma = 0;       ///< Per frame, m.
  double period = 0;      ///< Of bins, s.
  double shortest = 0;    ///< Run that is told from none, s.
  bool averaged = false;  ///< Bins hold several frames, so that those at edges are mixtures.

  /// By the noise of a stop of one tumble, less the bins at its edges.
  void setShortest(double frame_period);
};

/// What all tracks say about the scales.
struct ScaleSums {
  double time2 = 0;  ///< Of runs about their means, s^2.
  double drift = 0;  ///< s m.
  double runs = 0;
  double noise2 = 0;  ///< Of stops, m^2.
  double freedom = 0;
  std::vector<double> tumbles;  ///< s.

  /// @param sigma per frame, m
  [[nodiscard]] Measured speed(double sigma) const;

  /// Of single ones: neither two in a row nor a piece of one.
  [[nodiscard]] Measured tumble() const;
};

/// One track cut into visible runs and the standing between them.
class SegmentedTrack {
 public:
  /// @param first,last free times of its first and last frame, s
  SegmentedTrack(std::span<const TrackBin> bins, double first, double last, const Scales& scales);

  /// Joins stops whose distance is no run, by the scales as they are now.
  void mergeStops();

  void measure(ScaleSums& sums) const;

  /// Adds its runs and tumbles.
  void collect(FoundRuns& found) const;

 private:
  /// The run that ends at standing i, free of noise's share.
  [[nodiscard]] double runLength(std::size_t i) const;

  /// The bins of the run before standing i.
  [[nodiscard]] Stretch runBefore(std::size_t i) const;
  [[nodiscard]] Stretch runAfter(std::size_t i) const;

  [[nodiscard]] bool joined(const Stretch& run) const;

  /// When the robot came to standing i: its way there on the line of the run, at the speed.
  /// @param rough by the nearest bins where the run is too short for that.
  [[nodiscard]] std::optional<double> arrivalBy(std::size_t i, bool rough) const;
  [[nodiscard]] std::optional<double> departureBy(std::size_t i, bool rough) const;
  [[nodiscard]] std::optional<double> edge(const Stretch& run, const Place& place,
                                           const Place* other, double sign, bool rough,
                                           std::size_t bin) const;

  /// Tumbles begun in view while the robot stood; one that was going on when the track began was
  /// not.
  [[nodiscard]] std::int64_t tumblesIn(double stood, bool cut_before, bool cut_behind) const;

  /// The turn of the single tumble in standing i, whose runs before and behind are known.
  [[nodiscard]] double turn(std::size_t i) const;

  std::span<const TrackBin> bins_;
  double first_;
  double last_;
  const Scales& scales_;
  std::vector<Stretch> stretches_;
  std::vector<StopInterval> stops_;
};

}  // namespace lab::analysis::segmentation
