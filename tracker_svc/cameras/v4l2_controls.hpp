/// Exposure, gain and automatic adjustments of a video device.
#pragma once

#include "common/camera/cameras.hpp"
#include "tracker_svc/cameras/v4l2_calls.hpp"

namespace lab::cameras {

/// Switches off everything automatic (exposure, gain, white balance, focus, frame rate in low
/// light, ...), sets exposure and gain if wanted, within the limits of the device, and writes the
/// values read back to `format`: exposure, gain, and whether all automatic controls are off.
void lockControls(V4l2Calls& calls, int device, const CameraFormat& wanted, CameraFormat& format);

}  // namespace lab::cameras
