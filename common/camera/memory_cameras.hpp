/// The simulated camera inside one process, for virtual time and for tests.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "common/camera/cameras.hpp"
#include "common/loop/loop.hpp"

namespace lab {

/// Passes every frame to the readers at the time at which it is shown, after the painter's callback
/// has returned. Behaves as the shared camera (shared_camera.hpp), with the same error texts.
class MemoryCameras final : public Cameras {
 public:
  /// @param loop must outlive every source and sink
  explicit MemoryCameras(Loop& loop);
  ~MemoryCameras() override;

  /// @throws CameraError for any source but "sim"
  [[nodiscard]] std::unique_ptr<FrameSource> open(const std::string& source,
                                                  const CameraFormat& requested,
                                                  CameraHandlers handlers) override;
  [[nodiscard]] std::unique_ptr<FrameSink> offer(const CameraFormat& format) override;

  /// The number of frames that may wait for a reader before the oldest is lost.
  static constexpr std::size_t kSlots = 4;

 private:
  struct Shared;
  class Source;
  class Sink;

  [[nodiscard]] const std::shared_ptr<Shared>& shared(const std::string& name);

  Loop& loop_;
  std::map<std::string, std::shared_ptr<Shared>> shared_;  ///< by CameraFormat::name
};

}  // namespace lab
