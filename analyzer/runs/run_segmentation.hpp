#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace lab::analysis {

/// The mean of a few neighbouring frames of one robot.
struct TrackBin {
  double time = 0;    ///< Free time, s.
  double x = 0;       ///< m.
  double y = 0;       ///< m.
  double theta = 0;   ///< Unwrapped, rad; nan: not known.
  double frames = 0;  ///< How many.
  int piece = 0;      ///< As Sample::piece, of the last of them.
};

/// What is known of a run-and-tumble motion before it is cut into runs and stops.
struct MotionScales {
  double speed = 0;   ///< Of runs, m/s.
  double tumble = 0;  ///< Duration of one, s.
  double sigma = 0;   ///< Tracker noise per axis and frame, m.
  double period = 0;  ///< Between bins, s.
};

/// Neighbouring bins in one state of motion.
struct Stretch {
  bool run = false;  ///< False: standing.
  std::size_t begin = 0;
  std::size_t end = 0;

  [[nodiscard]] std::size_t size() const { return end - begin; }
};

/// Cuts a gap-free track into stops (a place) and runs (a straight line at the given speed), by the
/// largest likelihood of the whole track under normal noise: dynamic programming over all cuts, in
/// the manner of optimal partitioning (Jackson et al. 2005). Stops last at least 0.6 of a tumble,
/// unless cut off by an end of the track. Two stops may follow each other (a run between them that
/// no bin saw); two runs may not. The time goes as bins times bins in a run.
[[nodiscard]] std::vector<Stretch> segmentMotion(std::span<const TrackBin> bins,
                                                 const MotionScales& scales);

/// Sums of a stretch, relative to a bin in it.
struct StretchSums {
  double w = 0;
  double u = 0;
  double uu = 0;
  double x = 0;
  double y = 0;
  double q = 0;
  double ux = 0;
  double uy = 0;

  void add(const TrackBin& bin, const TrackBin& origin);

  [[nodiscard]] double time2() const { return uu - u * u / w; }  ///< About their mean, s^2.
  [[nodiscard]] double place2() const { return q - (x * x + y * y) / w; }  ///< m^2.
  [[nodiscard]] double driftX() const { return ux - u * x / w; }           ///< s m.
  [[nodiscard]] double driftY() const { return uy - u * y / w; }
};

}  // namespace lab::analysis
