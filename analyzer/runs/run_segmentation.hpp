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
  double frames = 0;  ///< Number of frames.
  int piece = 0;      ///< Sample::piece of the last frame.
};

/// The scales of runs and tumbles, used to segment it.
struct MotionScales {
  double speed = 0;   ///< Speed of runs, m/s.
  double tumble = 0;  ///< Duration of a tumble, s.
  double sigma = 0;   ///< Tracker noise per axis and frame, m.
  double period = 0;  ///< Time between bins, s.
};

/// Neighbouring bins in one state of motion.
struct Stretch {
  bool run = false;  ///< False: standing.
  std::size_t begin = 0;
  std::size_t end = 0;

  [[nodiscard]] std::size_t size() const { return end - begin; }
};

/// Segments a gap-free track into stops (constant position) and runs (straight lines at the given
/// speed) by maximum likelihood of the whole track under normal noise: dynamic programming over all
/// change points, as in optimal partitioning (Jackson et al. 2005). Stops last at least 0.6 of a
/// tumble, unless an end of the track cuts them off. Two stops may be adjacent (with a run between
/// them that no bin resolves), two runs may not. The computing time is proportional to the number
/// of bins times that in a run.
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

  [[nodiscard]] double time2() const {
    return uu - u * u / w;
  }  ///< Sum of squares about the mean time, s^2.
  [[nodiscard]] double place2() const {
    return q - (x * x + y * y) / w;
  }  ///< Sum of squares about the mean position, m^2.
  [[nodiscard]] double driftX() const { return ux - u * x / w; }  ///< s m.
  [[nodiscard]] double driftY() const { return uy - u * y / w; }
};

}  // namespace lab::analysis
