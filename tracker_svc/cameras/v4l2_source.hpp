/// A video device as a frame source on the loop.
#pragma once

#include <memory>
#include <string>

#include "common/camera/cameras.hpp"
#include "common/loop/asio_loop.hpp"
#include "tracker_svc/cameras/v4l2_calls.hpp"

namespace lab::cameras {

/// Opens a device. If it disappears, it is looked up once a second under the same path. A camera
/// that delivers nothing for two seconds is reported too.
/// @param calls must outlive the source
/// @throws CameraError as V4l2Device
[[nodiscard]] std::unique_ptr<FrameSource> openVideoDevice(AsioLoop& loop, V4l2Calls& calls,
                                                           const std::string& source,
                                                           const CameraFormat& wanted,
                                                           CameraHandlers handlers);

}  // namespace lab::cameras
