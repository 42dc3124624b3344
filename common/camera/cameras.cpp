#include "common/camera/cameras.hpp"

namespace lab {
namespace {

class NoCameras final : public Cameras {
 public:
  [[nodiscard]] std::unique_ptr<FrameSource> open(const std::string& source, const CameraFormat&,
                                                  CameraHandlers) override {
    throw CameraError(source + ": there are no cameras here");
  }
  [[nodiscard]] std::unique_ptr<FrameSink> offer(const CameraFormat&) override {
    throw CameraError("sim: there are no cameras here");
  }
};

}  // namespace

Cameras& noCameras() {
  static NoCameras none;
  return none;
}

}  // namespace lab
