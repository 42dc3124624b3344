/// sim_svc's camera, where an experiment wants real pictures of simulated robots.
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

/// How the simulated camera of an experiment paints: the camera over its arena, its exposure and
/// gain, the room's light, and the projector 28 cm behind the far wall. The calibration file is
/// what the tracker believes, not what the camera is, and plays no part here.
[[nodiscard]] PainterSettings painterSettings(const Experiment& experiment,
                                              const optics::ProjectorWarp& warp = {},
                                              const optics::ProjectorTones& tones = {});

/// Takes scenes and shows pictures of them, a delay later, to whoever watches.
class PaintedCamera {
 public:
  /// @param warp, tones of the light in the scenes
  /// @throws CameraError when this lab has a simulated camera already.
  PaintedCamera(const Experiment& experiment, Cameras& cameras, Loop& loop,
                const optics::ProjectorWarp& warp = {}, const optics::ProjectorTones& tones = {});

  /// The light in the scenes from now on.
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
  std::unique_ptr<FrameSink> sink_;
  CameraPainter painter_;
  std::shared_ptr<const light::Field> light_ = std::make_shared<light::Field>();
  std::shared_ptr<const light::Field> painted_light_;
};

}  // namespace lab::sim
