/// The simulated camera between processes: frames in shared memory, a socket that says which.
///
/// The socket has no file: its name, made from the lab's folder, is one of the kernel's and ends
/// with the process that listens. So a killed process leaves nothing behind, and only one can be
/// the camera of a folder. Both sides talk only to processes of their own user.
#pragma once

#include <filesystem>
#include <memory>

#include "common/camera/cameras.hpp"
#include "common/loop/asio_loop.hpp"

namespace lab::cameras {

/// Becomes the camera of the lab of this folder.
/// @throws CameraError when another process is it already.
[[nodiscard]] std::unique_ptr<FrameSink> offerSharedCamera(AsioLoop& loop,
                                                           const std::filesystem::path& folder,
                                                           const CameraFormat& format);

/// Reads the camera of the lab of this folder, which is waited for and found again. When nobody has
/// offered it for two seconds, that is trouble.
[[nodiscard]] std::unique_ptr<FrameSource> openSharedCamera(AsioLoop& loop,
                                                            const std::filesystem::path& folder,
                                                            const CameraFormat& wanted,
                                                            CameraHandlers handlers);

}  // namespace lab::cameras
