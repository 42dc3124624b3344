// Simple trackers with OpenCV, for comparison.
#pragma once

#include <vector>

#include "tracker_svc/detector.hpp"

namespace lab::cases {

enum class Plain {
  kAdaptive,  // adaptiveThreshold and findContours
  kBlobs,     // SimpleBlobDetector
};

// Returns poses without covariance.
std::vector<detector::Detection> findPlainly(Plain kind, const optics::GreyView& picture,
                                             const optics::CameraModel& camera,
                                             const optics::CapGeometry& cap);

}  // namespace lab::cases
