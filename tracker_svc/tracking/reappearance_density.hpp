/// Probability density of where a lost cap reappears.
#pragma once

#include <array>

#include "tracker_svc/detector.hpp"
#include "tracker_svc/tracking/motion.hpp"

namespace lab::tracker {

/// A mixture: the cap moved freely as its wheels report or last reported; it was held up on the
/// way; it has new speeds; or it is anywhere its wheels can take it. Hands may have carried it
/// farther.
class ReappearanceDensity {
 public:
  /// @param from last detected pose
  /// @param free pose expected without contacts
  /// @param reach [m] largest distance it can have driven since
  /// @param speed [m/s] highest speed
  ReappearanceDensity(const dynamics::Pose& from, const Reckoning& free, double reach,
                      double speed);

  /// [ln] of the density [1/(m^2 rad)] at a detection.
  [[nodiscard]] double logDensity(const detector::Detection& detection) const;

 private:
  dynamics::Pose from_;
  Reckoning free_;
  double reach_;
  double known_;  ///< [1] share of the time covered by wheel reports
  double kept_;   ///< [1] probability that it still has its last known speeds
  double drift_;  ///< [m] scale of the distance with other speeds
};

}  // namespace lab::tracker
