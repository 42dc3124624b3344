/// The simulated camera between processes: frames in shared memory, and a socket that announces
/// each frame.
///
/// The socket has an abstract name, derived from the lab's folder, which ends with the listening
/// process. A killed process therefore leaves no file behind, and only one process can be the
/// camera of a folder. Both sides accept only processes of their own user.
#pragma once

#include <filesystem>
#include <memory>

#include "common/camera/cameras.hpp"
#include "common/loop/asio_loop.hpp"

namespace lab::cameras {

/// Offers the simulated camera of the lab with this folder.
/// @throws CameraError if another process already offers it
[[nodiscard]] std::unique_ptr<FrameSink> offerSharedCamera(AsioLoop& loop,
                                                           const std::filesystem::path& folder,
                                                           const CameraFormat& format);

/// Reads the simulated camera of the lab with this folder. Waits for an absent camera, and
/// reconnects to a lost one. Reports trouble if it is not offered within two seconds.
[[nodiscard]] std::unique_ptr<FrameSource> openSharedCamera(AsioLoop& loop,
                                                            const std::filesystem::path& folder,
                                                            const CameraFormat& requested,
                                                            CameraHandlers handlers);

}  // namespace lab::cameras
