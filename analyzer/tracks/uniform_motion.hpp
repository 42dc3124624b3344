#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "analyzer/tracks/track_stitcher.hpp"

namespace lab::analysis {

/// Motion with a constant velocity, fitted to points of a track by least squares. SI units.
struct UniformMotion {
  double time = 0;  ///< middle, s
  double x = 0, y = 0;
  double vx = 0, vy = 0;
  double rms = 0;      ///< of the positions about the line, per axis, m
  double heading = 0;  ///< mean, rad
  double heading_rms = 0;

  [[nodiscard]] double speed() const { return std::hypot(vx, vy); }
  /// The cosine between heading and motion.
  [[nodiscard]] double cosine() const {
    return (vx * std::cos(heading) + vy * std::sin(heading)) / speed();
  }
};

/// The uniform motion of the points [begin, end) of a track, at least two.
[[nodiscard]] UniformMotion uniformMotion(const std::vector<TrackPoint>& track, std::size_t begin,
                                          std::size_t end);

/// The headings of a track without jumps of 2 pi, rad.
[[nodiscard]] std::vector<double> continuousHeadings(const std::vector<TrackPoint>& track);

/// uniformMotion() of a window that moves along a track, from running sums: the time for a step
/// does not depend on the length of the window. The mean heading is that of the continuous
/// headings; for the small scatter of a straight line it equals the direction of the mean vector.
class SlidingMotion {
 public:
  /// Keeps references. @param headings of continuousHeadings(track)
  SlidingMotion(const std::vector<TrackPoint>& track, const std::vector<double>& headings)
      : track_(track), headings_(headings) {}

  /// Moves the window to the points [begin, end). Neither may decrease.
  void moveTo(std::size_t begin, std::size_t end);

  [[nodiscard]] UniformMotion motion() const;

 private:
  /// Sums over the points of the window, relative to the point origin_: close to it, they lose no
  /// digits over hours of track.
  struct Sums {
    double t = 0, x = 0, y = 0, heading = 0;
    double tt = 0, tx = 0, ty = 0, xx = 0, yy = 0, heading2 = 0;
  };

  void add(std::size_t point, double sign);

  const std::vector<TrackPoint>& track_;
  const std::vector<double>& headings_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::size_t origin_ = 0;
  Sums sums_;
};

}  // namespace lab::analysis
