// Calibration files of camera, light, motors and projector. The first byte chooses the kind. What
// is written of a valid file must be valid too.
#include <cstdint>
#include <string>

#include "common/calibration/camera_file.hpp"
#include "common/calibration/light_file.hpp"
#include "common/calibration/motor_file.hpp"
#include "common/calibration/projector_file.hpp"
#include "common/files/experiment_error.hpp"
#include "light/optics/camera_model.hpp"
#include "light/optics/projector_model.hpp"
#include "tests/fuzz/input.hpp"
#include "tests/fuzz/memory_file.hpp"

namespace lab::fuzz {
namespace {

/// @return the text of a file, as written of what was read; empty: it cannot be written
std::string rewritten(char kind, const MemoryFile& file, const std::string& text) {
  switch (kind) {
    case 'c': {
      const CameraCalibration camera = readCameraFile(file.path());
      const optics::CameraModel model(camera.camera);
      for (const double pixel : {0.0, 100.0, 1e4}) {
        static_cast<void>(model.toPlane({pixel, pixel}, 0));
      }
      return cameraFileText(camera);
    }
    case 'l': {
      const LightCalibration light = parseLightFile("light.json", text);
      static_cast<void>(light.reading(1, LightSensor::kMean, 0.5));
      static_cast<void>(light.tone());
      return lightFileText(light);
    }
    case 'm':
      static_cast<void>(readMotorFile(file.path()));
      return {};
    default: {
      const ProjectorCalibration projector = readProjectorFile(file.path());
      static_cast<void>(projector.model());
      return projectorFileText(projector);
    }
  }
}

}  // namespace
}  // namespace lab::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  lab::fuzz::Input input(bytes, size);
  const char kind = input.number<char>();
  const std::string text = input.restAsText();
  const auto* content = reinterpret_cast<const std::uint8_t*>(text.data());
  std::string written;
  try {
    written = lab::fuzz::rewritten(kind, {content, text.size()}, text);
  } catch (const lab::ExperimentError&) {
    return 0;
  }
  if (written.empty()) return 0;
  content = reinterpret_cast<const std::uint8_t*>(written.data());
  static_cast<void>(lab::fuzz::rewritten(kind, {content, written.size()}, written));
  return 0;
}
