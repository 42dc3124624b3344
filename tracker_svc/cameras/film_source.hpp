/// Recordings as sources of a live lab.
#pragma once

#include <memory>
#include <string>

#include "common/camera/cameras.hpp"
#include "common/loop/asio_loop.hpp"

namespace lab::cameras {

/// Plays a recording on the loop, decoded in a separate thread. No frame is dropped: a slow
/// consumer delays the playback. `wanted.fps` as in CameraDevices.
/// @throws CameraError as FilmReader::open(), and if its size is not the wanted one
[[nodiscard]] std::unique_ptr<FrameSource> openFilm(AsioLoop& loop, const std::string& source,
                                                    const CameraFormat& wanted,
                                                    CameraHandlers handlers);

/// @throws CameraError if a size is wanted and it differs
void checkSize(const std::string& source, const CameraFormat& wanted, const CameraFormat& found);

}  // namespace lab::cameras
