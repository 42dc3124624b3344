#include "sim_svc/camera/painted_camera.hpp"

#include <algorithm>
#include <utility>

#include "common/math/units.hpp"
#include "light/optics/simulated_camera.hpp"

namespace lab::sim {
namespace {

constexpr double kBehindTheWall = 0.28;    // [m] distance of the projector from the far wall
constexpr double kProjectorHeight = 2.10;  // [m]

CameraFormat formatOf(const Camera& camera) {
  CameraFormat format;
  format.width = camera.width;
  format.height = camera.height;
  format.fps = camera.fps;
  format.exposure = camera.exposure;
  format.gain = camera.gain;
  format.name = camera.name;
  return format;
}

}  // namespace

PainterSettings painterSettings(const Experiment& experiment, const optics::ProjectorWarp& warp,
                                const optics::ProjectorTones& tones) {
  PainterSettings settings;
  const Camera& camera = experiment.camera;
  const CameraView& view = camera.view;
  settings.camera =
      optics::simulatedCameraAbove(camera.width, camera.height, view.x, view.y,
                                   view.width > 0 ? view.width : experiment.arena_width,
                                   view.height > 0 ? view.height : experiment.arena_height);
  settings.cap.robot_radius = experiment.hardware.diameter / 2;
  if (camera.marker != Marker::kCaps) {
    constexpr double kLowest = 0.001;  // [m] of a robot
    settings.cap.height = std::max(camera.marker_height, kLowest);
    settings.top = camera.marker == Marker::kTags ? RobotTop::kTag : RobotTop::kSpot;
    settings.spot_radius = (camera.blob_smallest + camera.blob_largest) / 4;
    settings.bright_spot = camera.blob == BlobTone::kBright;
    settings.tag_family = entryOf(camera.tag_family).name;
    settings.tag_size = camera.tag_size;
  }
  settings.arena_width = experiment.arena_width;
  settings.arena_height = experiment.arena_height;
  settings.projector = {experiment.arena_width / 2, experiment.arena_height + kBehindTheWall,
                        kProjectorHeight};
  settings.warp = warp;
  settings.tones = tones;
  settings.sheet = experiment.projector.sheet;
  settings.ambient = experiment.camera.ambient;
  settings.exposure = experiment.camera.exposure;
  settings.gain = experiment.camera.gain;
  settings.seed = experiment.seed;
  return settings;
}

PaintedCamera::PaintedCamera(const Experiment& experiment, Cameras& cameras, Loop& loop,
                             const optics::ProjectorWarp& warp, const optics::ProjectorTones& tones)
    : loop_(loop),
      delay_us_(units::microseconds(experiment.camera.delay)),
      clock_error_us_(units::microseconds(experiment.camera.clock_error)),
      sink_(cameras.offer(formatOf(experiment.camera))),
      painter_(painterSettings(experiment, warp, tones)) {}

void PaintedCamera::show(light::Field field) {
  light_ = std::make_shared<const light::Field>(std::move(field));
}

void PaintedCamera::take(std::int64_t number, std::int64_t exposure_utime,
                         std::vector<PaintedRobot> robots) {
  if (!sink_->isWatched()) return;
  loop_.at(
      exposure_utime + delay_us_,
      [this, scene = Scene{number, exposure_utime, light_, std::move(robots)}] { develop(scene); });
}

void PaintedCamera::develop(const Scene& scene) {
  // A picture depends only on its own scene, so pictures without a subscriber need not be painted.
  if (!sink_->isWatched()) return;
  if (scene.light != painted_light_) painter_.setLight(*scene.light);
  painted_light_ = scene.light;
  painter_.paint(scene.robots, scene.number, sink_->canvas());
  sink_->show(scene.number, scene.exposure_utime + clock_error_us_);
}

}  // namespace lab::sim
