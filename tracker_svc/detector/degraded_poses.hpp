/// Poses of caps of which only one circle is visible.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "tracker_svc/detection.hpp"
#include "tracker_svc/detector/fitted_circles.hpp"
#include "tracker_svc/detector/known_caps.hpp"

namespace lab::detector {

struct DegradedPose {
  std::size_t expected;  ///< index
  Detection pose;
};

/// Combines one circle with the rim of the cap, near expected poses.
class DegradedPoses {
 public:
  DegradedPoses(const DetectorSetup& setup, FittedCircles& circles, const KnownCaps& known)
      : setup_(setup), circles_(circles), known_(known) {}

  /// Degraded poses of the expected caps that are not known; valid until the next call.
  const std::vector<DegradedPose>& find(std::span<const Expected> expected);

 private:
  /// Quality 0 if there is none.
  [[nodiscard]] Detection poseFromOne(const Expected& expected);
  /// The only good circle where the circles of the cap can be; -1 if there is none, if there are
  /// several, or if its size is ambiguous.
  [[nodiscard]] int unpairedCircle(const Expected& expected, bool& is_big);

  const DetectorSetup& setup_;
  FittedCircles& circles_;
  const KnownCaps& known_;
  std::vector<DegradedPose> degraded_;
};

}  // namespace lab::detector
