/// Cameras in real time: devices, recordings, network cameras, and the simulated camera in shared
/// memory.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "common/camera/cameras.hpp"
#include "common/experiment/experiment.hpp"
#include "common/loop/asio_loop.hpp"

namespace lab {

/// Whether `source` names a recording: pictures or a movie, and no camera.
[[nodiscard]] bool isFilm(const std::string& source);

/// What an experiment asks of its camera.
[[nodiscard]] CameraFormat wantedFormat(const Camera& camera);

/// docs/cameras.md lists the sources. Of files, `wanted.fps` above 0 is the rate at which they are
/// played, 0 means their own rate and below 0 as fast as they are read; none of their frames is
/// lost.
class CameraDevices final : public Cameras {
 public:
  /// @param loop must outlive every source and sink
  /// @param folder names the lab: the simulated camera is found by who is given the same folder.
  ///   Nothing is written into it; it need not exist.
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
