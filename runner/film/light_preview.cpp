#include "runner/film/light_preview.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>

#include "light/field/raster.hpp"
#include "runner/film/preview_marks.hpp"
#include "sim_svc/placement.hpp"

namespace lab::runner {
namespace {

constexpr std::int64_t kStart_utime = 1'000'000;
constexpr double kFramePeriod = 0.2;  // [s] period of the tracker frames that the layers receive
constexpr double kLongestTrail = 60;  // [s] length of a trail
constexpr double kVisibleDistance = 0.2;   // [m] distance after which a motion is visible
constexpr double kDefaultSpan = 10;        // [s] for light without a period
constexpr std::uint8_t kBesideArena = 96;  // grey, neither dark nor full light

std::int64_t utimeAt(double time) {
  return kStart_utime + static_cast<std::int64_t>(std::llround(time * 1e6));
}

/// Time in which the motion of a layer becomes visible [s].
double spanOf(const LayerSpec& layer) {
  const light::Drive& drive = layer.drive;
  const bool noise = static_cast<light::LayerKind>(layer.kind) == light::LayerKind::kNoise;
  const bool telegraph = drive.waveform == light::Waveform::kTelegraph;
  double span = 0;
  const auto extend = [&](double time) { span = std::max(span, time); };
  if (const double speed = std::hypot(drive.vx, drive.vy); speed > 0)
    extend(kVisibleDistance / speed);
  if (drive.spin != 0) extend(2 * std::numbers::pi / std::abs(drive.spin));
  if (drive.phase_rate != 0) {
    extend((noise ? 2 : 2 * std::numbers::pi) / std::abs(drive.phase_rate));
  }
  if (drive.waveform != light::Waveform::kSteady) extend((telegraph ? 4 : 1) * drive.period);
  if (!drive.images.empty()) extend(static_cast<double>(drive.images.size()) / drive.image_rate);
  if (drive.follow == light::Follow::kTrail) extend(kDefaultSpan);
  return span;
}

/// The frame with all robots at their start poses.
projector::ObservedFrame startOf(const Experiment& experiment) {
  std::vector<sim::Place> places;
  projector::ObservedFrame frame;
  for (const RobotSpec& robot : experiment.robots) {
    std::optional<dynamics::Pose> pose;
    if (robot.start) pose = dynamics::Pose{robot.start->x, robot.start->y, robot.start->theta};
    if (isSimulated(robot.body)) {
      places.push_back({robot.id, pose});
    } else if (pose) {
      frame.robots.push_back({.id = robot.id, .x = pose->x, .y = pose->y, .theta = pose->theta});
    }
  }
  const std::vector<dynamics::Pose> poses =
      sim::placeRobots(places, {experiment.arena_width, experiment.arena_height},
                       experiment.hardware.diameter / 2, experiment.seed);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    frame.robots.push_back(
        {.id = places[i].id, .x = poses[i].x, .y = poses[i].y, .theta = poses[i].theta});
  }
  return frame;
}

}  // namespace

LightPreview::LightPreview(const Experiment& experiment, const ExperimentImages& images)
    : experiment_(experiment), start_frame_(startOf(experiment)) {
  scene_context_.arena_width = experiment.arena_width;
  scene_context_.arena_height = experiment.arena_height;
  for (const RobotSpec& robot : experiment.robots) scene_context_.robots.push_back(robot.id);
  scene_context_.images = images.store;
  for (const LightStep& step : experiment.light.steps) {
    std::vector<light::DrivenLayer> layers = toDrivenLayers(step.layers, images);
    for (light::DrivenLayer& layer : layers) {
      if (layer.drive.gate == light::Gate::kProgram) layer.drive.gate = light::Gate::kOpen;
    }
    steps_.push_back({projector::Scene(std::move(layers), kStart_utime, scene_context_),
                      projector::RobotTracks(scene_context_.robots)});
  }
}

double LightPreview::length(std::size_t step) const {
  const LightScript& script = experiment_.light;
  const double begin = script.steps[step].at;
  if (step + 1 < script.steps.size()) return script.steps[step + 1].at - begin;
  return std::max(0.0, (script.repeat ? script.length : experiment_.duration) - begin);
}

double LightPreview::span(std::size_t step) const {
  double span = 0;
  for (const LayerSpec& layer : experiment_.light.steps[step].layers) {
    span = std::max(span, spanOf(layer));
  }
  return std::min(span, length(step));
}

std::vector<double> LightPreview::moments(std::size_t step) const {
  const double begin = std::min(experiment_.light.steps[step].ramp, length(step));
  const double rest = std::min(span(step), length(step) - begin);
  if (rest <= 0) return {begin};
  return {begin, begin + 0.25 * rest, begin + 0.5 * rest, begin + 0.75 * rest};
}

std::vector<light::Layer> LightPreview::layers(std::size_t step, double time) {
  Step& shown = steps_[step];
  if (shown.scene.needsPoses()) {
    double next = std::max(shown.seen + kFramePeriod, std::max(0.0, time - kLongestTrail));
    for (;; next += kFramePeriod) {
      next = std::min(next, time);
      if (next > shown.seen) {
        start_frame_.utime = utimeAt(next);
        ++start_frame_.number;
        shown.robots.add(start_frame_);
        shown.scene.addFrame(start_frame_, shown.robots);
        shown.seen = next;
      }
      if (next >= time) break;
    }
  }
  const std::int64_t now = utimeAt(time);
  return shown.scene.at({.decided = now, .shown = now}, shown.robots).layers;
}

light::Field LightPreview::field(std::size_t step, double time) {
  light::Field field{layers(step, time), {}, 1};
  const double ramp = experiment_.light.steps[step].ramp;
  if (time >= ramp) return field;
  field.mix = time / ramp;
  if (step > 0) field.previous = layers(step - 1, length(step - 1));
  return field;
}

optics::RgbImage LightPreview::picture(std::size_t step, double time, int width) {
  const light::PictureSize size =
      light::pictureSize(experiment_.arena_width, experiment_.arena_height, width);
  const PreviewMarks marks(experiment_, width, size.nx, !start_frame_.robots.empty());
  const light::Raster raster = light::rasterise(field(step, time), experiment_.arena_width,
                                                experiment_.arena_height, size.nx, size.ny);
  const std::vector<std::uint8_t> grey = light::toGrey(raster);
  optics::RgbImage image(width, size.ny + marks.headHeight());
  auto value = grey.begin();
  for (int row = image.height - size.ny; row < image.height; ++row) {
    std::uint8_t* pixel = image.at(0, row);
    for (int column = 0; column < size.nx; ++column) pixel = std::fill_n(pixel, 3, *value++);
    std::fill_n(pixel, 3 * (width - size.nx), kBesideArena);
  }
  const LightStep& shown = experiment_.light.steps[step];
  marks.drawHead(image, fmt::format("{:.2f} s  {}", shown.at + time, shown.label), raster);
  marks.drawBands(image, raster);
  marks.drawRobots(image, start_frame_);
  marks.drawScale(image);
  return image;
}

}  // namespace lab::runner
