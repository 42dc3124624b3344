/// Sources of camera frames in real time: video devices, recordings, network cameras, and the
/// simulated camera in shared memory.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "common/camera/cameras.hpp"
#include "common/experiment/experiment.hpp"
#include "common/loop/asio_loop.hpp"

namespace lab {

/// Whether `source` names a recording (pictures or a movie) rather than a camera.
[[nodiscard]] bool isFilm(const std::string& source);

/// The camera format that an experiment asks for.
[[nodiscard]] CameraFormat wantedFormat(const Camera& camera);

/// docs/cameras.md lists the sources. For recordings, `wanted.fps` above 0 is the playback rate, 0
/// means the recording's own rate, and below 0 as fast as frames are read. No frame of a recording
/// is skipped.
class CameraDevices final : public Cameras {
 public:
  /// @param loop must outlive every source and sink
  /// @param folder identifies the lab: processes that use the same folder share the simulated
  ///   camera. Nothing is written into the folder; it need not exist.
  CameraDevices(AsioLoop& loop, std::filesystem::path folder);
  ~CameraDevices() override;

  [[nodiscard]] std::unique_ptr<FrameSource> open(const std::string& source,
                                                  const CameraFormat& wanted,
                                                  CameraHandlers handlers) override;
  [[nodiscard]] std::unique_ptr<FrameSink> offer(const CameraFormat& format) override;

 private:
  AsioLoop& loop_;
  std::filesystem::path folder_;
};

}  // namespace lab
