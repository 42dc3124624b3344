#include "tracker_svc/camera_devices.hpp"

#include <utility>

#include "common/camera/camera_source.hpp"
#include "common/camera/shared_camera.hpp"
#include "tracker_svc/cameras/film_source.hpp"
#include "tracker_svc/cameras/stream_source.hpp"
#include "tracker_svc/cameras/v4l2_source.hpp"

namespace lab {

bool isFilm(const std::string& source) {
  // The file of a run names its pipeline "pipeline"; the tracker gets that name when it tracks the
  // run's film again.
  return source != kSimulatedCamera && source != kPipelineCamera && !isVideoDeviceSource(source) &&
         !cameras::isStreamSource(source);
}

CameraFormat wantedFormat(const Camera& camera) {
  CameraFormat format;
  format.width = camera.width;
  format.height = camera.height;
  format.fps = isFilm(camera.source) ? 0 : camera.fps;  // a recording has its own rate
  format.exposure = camera.exposure;
  // 0 leaves the device's gain unchanged. The default of 1 is not sent: its unit depends on the
  // device.
  const bool set = camera.source == kSimulatedCamera || camera.gain != Camera{}.gain;
  format.gain = set ? camera.gain : 0;
  format.name = camera.name;
  return format;
}

CameraDevices::CameraDevices(AsioLoop& loop, std::filesystem::path folder)
    : loop_(loop), folder_(std::move(folder)) {}

CameraDevices::~CameraDevices() = default;

std::unique_ptr<FrameSource> CameraDevices::open(const std::string& source,
                                                 const CameraFormat& wanted,
                                                 CameraHandlers handlers) {
  if (source == "sim") {
    return cameras::openSharedCamera(loop_, folder_, wanted, std::move(handlers));
  }
  if (isVideoDeviceSource(source)) {
    return cameras::openVideoDevice(loop_, cameras::systemV4l2Calls(), source, wanted,
                                    std::move(handlers));
  }
  if (cameras::isStreamSource(source)) {
    return cameras::openStream(loop_, source, wanted, std::move(handlers));
  }
  return cameras::openFilm(loop_, source, wanted, std::move(handlers));
}

std::unique_ptr<FrameSink> CameraDevices::offer(const CameraFormat& format) {
  return cameras::offerSharedCamera(loop_, folder_, format);
}

}  // namespace lab
