/// The cameras of a process that only offers or reads the simulated camera.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "common/camera/cameras.hpp"
#include "common/loop/asio_loop.hpp"

namespace lab {

/// Has one camera, the simulated one in shared memory. CameraDevices of tracker_svc has all
/// cameras.
class SharedCameras final : public Cameras {
 public:
  /// @param loop must outlive every source and sink
  /// @param folder identifies the lab: a camera is read under the folder under which it is offered.
  ///   Nothing is written into it, and it need not exist.
  SharedCameras(AsioLoop& loop, std::filesystem::path folder);

  /// @throws CameraError for any source but "sim"
  [[nodiscard]] std::unique_ptr<FrameSource> open(const std::string& source,
                                                  const CameraFormat& requested,
                                                  CameraHandlers handlers) override;
  [[nodiscard]] std::unique_ptr<FrameSink> offer(const CameraFormat& format) override;

 private:
  AsioLoop& loop_;
  std::filesystem::path folder_;
};

}  // namespace lab
