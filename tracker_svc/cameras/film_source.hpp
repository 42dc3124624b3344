/// Recordings and network cameras as sources of a live lab.
#pragma once

#include <memory>
#include <string>

#include "common/camera/cameras.hpp"
#include "common/loop/asio_loop.hpp"

namespace lab::cameras {

/// Plays a recording on the loop, decoded by a thread of its own. No frame is lost: a reader that
/// is slow makes it late. `wanted.fps` as in CameraDevices.
/// @throws CameraError as FilmReader::open(), and when its size is not the one wanted.
[[nodiscard]] std::unique_ptr<FrameSource> openFilm(AsioLoop& loop, const std::string& source,
                                                    const CameraFormat& wanted,
                                                    CameraHandlers handlers);

/// A camera behind an address ("rtsp://...", "http://...") that ffmpeg reads, or behind a GStreamer
/// pipeline ("gst:aravissrc ! ..."). When it ends it is begun anew each second.
/// @throws CameraError when it cannot be reached now, when its size is not the one wanted.
[[nodiscard]] std::unique_ptr<FrameSource> openStream(AsioLoop& loop, const std::string& source,
                                                      const CameraFormat& wanted,
                                                      CameraHandlers handlers);

/// Whether openStream() is for this source.
[[nodiscard]] bool isStreamSource(const std::string& source);

/// @throws CameraError unless the size is the one wanted, where one is wanted.
void checkSize(const std::string& source, const CameraFormat& wanted, const CameraFormat& found);

}  // namespace lab::cameras
