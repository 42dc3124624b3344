/// Estimates the offsets between the clocks of cameras from the robots that they see together.
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>
#include <vector>

namespace lab::tracker {

/// The time stamps of a camera are later than those of the first camera by `offset`.
struct ClockOffset {
  double offset = 0;                                       ///< [s]
  double sigma = std::numeric_limits<double>::infinity();  ///< [s] standard error; not known: inf
};

/// A robot with velocity v that two cameras a and b stamp at the same time appears displaced by
/// -v (offset_b - offset_a). Least squares over all robots in an overlap give the difference of the
/// offsets, together with a constant displacement of the two calibrations. A second least squares
/// over all pairs gives the offsets from the first camera. Robots that drive in one direction
/// with one speed cannot tell the two apart; the standard error is then infinite or large.
///
/// The standard error follows from the given covariances, multiplied by the root of the reduced
/// chi-square if that is above 1. It assumes that the errors of different pictures are independent.
class ClockOffsets {
 public:
  explicit ClockOffsets(std::size_t cameras) : cameras_(cameras) {}

  /// Adds a robot that cameras a and b see.
  /// @param displacement [m] its place by b minus that by a, both moved to one time stamp
  /// @param velocity [m/s]
  /// @param covariance [m^2] of the displacement
  void add(std::size_t a, std::size_t b, const Eigen::Vector2d& displacement,
           const Eigen::Vector2d& velocity, const Eigen::Matrix2d& covariance);

  /// By camera; the first one is {0, 0}.
  [[nodiscard]] std::vector<ClockOffset> solve() const;

 private:
  /// Normal equations of (offset, constant displacement x, y).
  struct Pair {
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d weighted = Eigen::Vector3d::Zero();
    double squares = 0;
    std::int64_t count = 0;
  };

  std::size_t cameras_;
  std::map<std::pair<std::size_t, std::size_t>, Pair> pairs_;  ///< by cameras, the lower one first
};

}  // namespace lab::tracker
