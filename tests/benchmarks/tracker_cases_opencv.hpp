// The tracker that is easily written with OpenCV, to compare with.
#pragma once

#include <vector>

#include "tracker_svc/detector.hpp"

namespace lab::cases {

enum class Plain {
  kAdaptive,  // adaptiveThreshold and findContours
  kBlobs,     // SimpleBlobDetector
};

// Poses without covariance.
std::vector<detector::Detection> findPlainly(Plain kind, const optics::GreyView& picture,
                                             const optics::CameraModel& camera,
                                             const optics::CapGeometry& cap);

}  // namespace lab::cases
