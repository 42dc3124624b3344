// Other detectors of blobs and tags, for comparison.
#pragma once

#include <vector>

#include "light/optics/grey_image.hpp"
#include "tests/support/marker_scenes/marker_scene.hpp"
#include "tracker_svc/detection.hpp"

namespace lab::cases {

// Whether OpenCV's SimpleBlobDetector was there when this was built.
[[nodiscard]] bool hasBlobBaseline();

// libapriltag alone for tags, SimpleBlobDetector for blobs. Poses without covariance.
[[nodiscard]] std::vector<detector::Detection> baseline(const MarkerKind& kind,
                                                        const optics::GreyView& picture);

}  // namespace lab::cases
