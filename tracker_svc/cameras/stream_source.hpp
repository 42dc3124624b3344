/// Network cameras and GStreamer pipelines as sources of a live lab.
#pragma once

#include <memory>
#include <string>

#include "common/camera/cameras.hpp"
#include "common/loop/asio_loop.hpp"

namespace lab::cameras {

/// Opens a camera behind a URL ("rtsp://...", "http://...") that ffmpeg reads, or behind a
/// GStreamer pipeline ("gst:aravissrc ! ..."). If the stream ends, it is reopened once a second.
/// @throws CameraError if it cannot be reached now, or its size is not the wanted one
[[nodiscard]] std::unique_ptr<FrameSource> openStream(AsioLoop& loop, const std::string& source,
                                                      const CameraFormat& wanted,
                                                      CameraHandlers handlers);

/// Whether openStream() handles this source.
[[nodiscard]] bool isStreamSource(const std::string& source);

}  // namespace lab::cameras
