/// What is at the place that the source of a camera names. Nothing here opens a device or a pipe.
#pragma once

#include <string>

namespace lab {

/// 0 if a video device is at this path, ENOTTY if something else is, otherwise the errno by which
/// the path cannot be read.
[[nodiscard]] int videoDeviceError(const std::string& path);

/// Why the source cannot be a camera: "found ..., expected ..."; empty if it can be one, or if
/// nothing is there, as on a machine other than that of the camera. Addresses and patterns of
/// pictures are not looked up, and the content of a file is not read.
[[nodiscard]] std::string cameraPlaceProblem(const std::string& source);

}  // namespace lab
