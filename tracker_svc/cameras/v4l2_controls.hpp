/// Exposure, gain and whatever a camera adjusts by itself.
#pragma once

#include "common/camera/cameras.hpp"
#include "tracker_svc/cameras/v4l2_calls.hpp"

namespace lab::cameras {

/// Switches off what is automatic (exposure, gain, white balance, focus, frame rate by light, ...),
/// sets exposure and gain where they are wanted, within what the device allows, and writes into
/// `format` what the device says it has: exposure, gain, and whether nothing is automatic any more.
void lockControls(V4l2Calls& calls, int device, const CameraFormat& wanted, CameraFormat& format);

}  // namespace lab::cameras
