/// Fuses poses of the same robots from several cameras.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "tracker_svc/detection.hpp"

namespace lab::tracker {

/// One detection of one camera, at the time of the round.
struct Sighting {
  std::size_t camera = 0;
  detector::Detection pose;
};

struct FusionSettings {
  /// [m] Two robots in contact are farther apart than this: nearer poses of different cameras are
  /// of one robot.
  double same = 0.03;
  /// [m] standard deviation per axis of the difference of two calibrations, used by the gate only
  double calibration_error = 2e-4;
  double heading_error = 0.01;  ///< [rad] the same of headings
  double gate = 16.27;          ///< [1] 99.9 % quantile of chi-square with 3 degrees of freedom
};

/// A robot in one round.
struct FusedPose {
  detector::Detection pose;
  std::vector<std::size_t> sightings;  ///< indices of all its sightings, the best one first
  std::size_t rejected = 0;            ///< of these, not used: degraded or outside the gate
};

/// The mean of poses weighted by their inverse covariances, and its covariance, the inverse of the
/// sum of the inverse covariances. All else is that of the first pose.
/// @param poses at least one; headings differ by less than half a turn from the first one
[[nodiscard]] detector::Detection fusePoses(std::span<const detector::Detection> poses);

/// Groups the sightings of a round by robots and fuses each group. A camera contributes at most one
/// pose to a robot. A pose that contradicts the best one of its robot by chi-square is rejected;
/// so is a degraded pose (detector::kUsedRim) beside a full one.
/// @return ordered by the place of the best sighting in `sightings`
[[nodiscard]] std::vector<FusedPose> fuseSightings(std::span<const Sighting> sightings,
                                                   const FusionSettings& settings);

}  // namespace lab::tracker
