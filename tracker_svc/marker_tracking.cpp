#include "tracker_svc/marker_tracking.hpp"

#include <utility>

#include "tracker_svc/tracking/motion_tracker.hpp"
#include "tracker_svc/tracking/tag_tracker.hpp"

namespace lab::tracker {

std::unique_ptr<MarkerTracker> makeMarkerTracker(const detector::MarkerSettings& markers,
                                                 const TrackerSettings& settings,
                                                 std::vector<std::int32_t> robot_ids,
                                                 double max_speed) {
  switch (markers.kind) {
    case detector::MarkerKind::kBlobs:
      return std::make_unique<MotionTracker>(
          MotionTrackerSettings{.step = (markers.blobs.smallest + markers.blobs.largest) / 4,
                                .max_speed = max_speed,
                                .area = settings.arena_width * settings.arena_height});
    case detector::MarkerKind::kTags:
      return std::make_unique<TagTracker>(settings.max_wheel_speed, std::move(robot_ids));
    case detector::MarkerKind::kCaps:
      break;
  }
  return std::make_unique<CapTracker>(settings, std::move(robot_ids));
}

}  // namespace lab::tracker
