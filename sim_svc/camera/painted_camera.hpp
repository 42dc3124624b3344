/// The camera of sim_svc for experiments that track simulated robots by pictures.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "common/camera/cameras.hpp"
#include "common/experiment/experiment.hpp"
#include "common/loop/loop.hpp"
#include "light/field/field.hpp"
#include "sim_svc/camera_painter.hpp"

namespace lab::sim {

/// The painter's settings for an experiment: the camera over its arena, exposure and gain, the room
/// light, and the projector 28 cm behind the far wall. The calibration file is not used, because
/// the tracker uses it; the simulated camera may differ from it.
[[nodiscard]] PainterSettings painterSettings(const Experiment& experiment,
                                              const optics::ProjectorWarp& warp = {},
                                              const optics::ProjectorTones& tones = {});

/// Exposes scenes and delivers their pictures to the subscribers after the camera's delay.
class PaintedCamera {
 public:
  /// @param warp, tones errors of the projector
  /// @throws CameraError if there is already a simulated camera in this process.
  PaintedCamera(const Experiment& experiment, Cameras& cameras, Loop& loop,
                const optics::ProjectorWarp& warp = {}, const optics::ProjectorTones& tones = {});

  /// Sets the light in the scenes.
  void show(light::Field field);

  /// Takes a picture of the robots as they are at `exposure_utime`, the middle of the exposure.
  void take(std::int64_t number, std::int64_t exposure_utime, std::vector<PaintedRobot> robots);

 private:
  struct Scene {
    std::int64_t number = 0;
    std::int64_t exposure_utime = 0;
    std::shared_ptr<const light::Field> light;
    std::vector<PaintedRobot> robots;
  };

  void develop(const Scene& scene);

  Loop& loop_;
  std::int64_t delay_us_;
  std::int64_t clock_error_us_;
  std::unique_ptr<FrameSink> sink_;
  CameraPainter painter_;
  std::shared_ptr<const light::Field> light_ = std::make_shared<light::Field>();
  std::shared_ptr<const light::Field> painted_light_;
};

}  // namespace lab::sim
