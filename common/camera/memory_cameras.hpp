/// The simulated camera inside one process, for virtual time and for tests.
#pragma once

#include <memory>
#include <string>

#include "common/camera/cameras.hpp"
#include "common/loop/loop.hpp"

namespace lab {

/// Hands every frame over at the instant at which it is shown, as soon as the painter has returned.
/// It behaves as the shared-memory ring of CameraDevices does, with the same words.
class MemoryCameras final : public Cameras {
 public:
  /// @param loop must outlive every source and sink
  explicit MemoryCameras(Loop& loop);
  ~MemoryCameras() override;

  /// @throws CameraError for any source but "sim": in memory there is no other.
  [[nodiscard]] std::unique_ptr<FrameSource> open(const std::string& source,
                                                  const CameraFormat& wanted,
                                                  CameraHandlers handlers) override;
  [[nodiscard]] std::unique_ptr<FrameSink> offer(const CameraFormat& format) override;

  /// So many frames may wait for a reader before the oldest is lost.
  static constexpr std::size_t kSlots = 4;

 private:
  struct Shared;
  class Source;
  class Sink;

  std::shared_ptr<Shared> shared_;
};

}  // namespace lab
