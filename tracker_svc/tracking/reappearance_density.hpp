/// Where a cap that was not seen for a while may come back, as a probability density.
#pragma once

#include <array>

#include "tracker_svc/detector.hpp"
#include "tracker_svc/tracking/motion.hpp"

namespace lab::tracker {

/// A cap may have rolled freely as its wheels say, or said last; been held up on its way by others;
/// have drawn new speeds; or have gone anywhere its wheels can take it. Hands may have taken it
/// farther.
class ReappearanceDensity {
 public:
  /// @param from where it was last seen
  /// @param free where it would be had nothing held it up
  /// @param reach [m] how far it can have driven since
  /// @param speed [m/s] the highest
  ReappearanceDensity(const dynamics::Pose& from, const Reckoning& free, double reach,
                      double speed);

  /// Natural logarithm of the density [1/(m^2 rad)] at a detection.
  [[nodiscard]] double logDensity(const detector::Detection& detection) const;

 private:
  dynamics::Pose from_;
  Reckoning free_;
  double reach_;
  double known_;  ///< [1] share of the time that is covered by wheel reports
  double kept_;   ///< [1] chance that it still has the speeds that were known last
  double drift_;  ///< [m] how far it may be from there with other speeds
};

}  // namespace lab::tracker
