/// The tracker that belongs to a kind of markers.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "tracker_svc/marker_detector.hpp"
#include "tracker_svc/tracking/cap_tracker.hpp"
#include "tracker_svc/tracking/marker_tracker.hpp"

namespace lab::tracker {

/// Caps are bound to robots by their motion; tags are robots by their numbers; blobs have no
/// identity but that of their track.
/// @param settings of the arena; robots and wheels only for caps and tags
/// @param max_speed [m/s] no blob is faster; 0: not known
[[nodiscard]] std::unique_ptr<MarkerTracker> makeMarkerTracker(
    const detector::MarkerSettings& markers, const TrackerSettings& settings,
    std::vector<std::int32_t> robot_ids, double max_speed = 0);

}  // namespace lab::tracker
