#include "common/camera/shared_cameras.hpp"

#include <utility>

#include "common/camera/shared_camera.hpp"

namespace lab {

SharedCameras::SharedCameras(AsioLoop& loop, std::filesystem::path folder)
    : loop_(loop), folder_(std::move(folder)) {}

std::unique_ptr<FrameSource> SharedCameras::open(const std::string& source,
                                                 const CameraFormat& requested,
                                                 CameraHandlers handlers) {
  if (source != "sim") {
    throw CameraError(source + ": this program reads no camera but the simulated one, \"sim\"");
  }
  return cameras::openSharedCamera(loop_, folder_, requested, std::move(handlers));
}

std::unique_ptr<FrameSink> SharedCameras::offer(const CameraFormat& format) {
  return cameras::offerSharedCamera(loop_, folder_, format);
}

}  // namespace lab
