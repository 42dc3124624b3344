/// Recordings as sources of a live lab.
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

/// @throws CameraError unless the size is the one wanted, where one is wanted.
void checkSize(const std::string& source, const CameraFormat& wanted, const CameraFormat& found);

}  // namespace lab::cameras
