#include "projector_ctl/scene.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <utility>

#include "common/math/angle.hpp"
#include "common/math/units.hpp"

namespace lab::projector {
namespace {

using light::Drive;
using light::DrivenLayer;
using light::Follow;
using light::Gate;
using light::Layer;
using light::LayerKind;

constexpr std::size_t kLayerBytes = 110;            // size of a light_layer_t without image or grid
constexpr std::size_t kDigestBytes = 64;            // size of an image's SHA-256
constexpr std::size_t kMostTrailCells = 160 * 120;  // sum over all trails of a command
constexpr std::size_t kMostNamed = 8;               // lost robots named in one text

using units::seconds;

/// The time of day in UTC, as "12:34:56.789".
std::string clockText(std::int64_t utime) {
  const std::chrono::hh_mm_ss time{std::chrono::milliseconds(utime / 1000 % (24LL * 3600 * 1000))};
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%02d:%02d:%02d.%03d",
                static_cast<int>(time.hours().count()), static_cast<int>(time.minutes().count()),
                static_cast<int>(time.seconds().count()),
                static_cast<int>(time.subseconds().count()));
  return buffer;
}

std::string troubleText(const std::map<std::int32_t, std::int64_t>& lost, bool safe) {
  if (lost.empty()) return {};
  std::string all = safe ? "safe field: lost " : "lost: ";
  std::size_t named = 0;
  for (const auto& [id, since] : lost) {
    if (named == kMostNamed) {
      return all + " and " + std::to_string(lost.size() - named) + " more";
    }
    if (named++ > 0) all += ", ";
    all += "robot " + std::to_string(id) +
           (since == 0 ? " (not seen yet)" : " (last seen " + clockText(since) + " UTC)");
  }
  return all;
}

/// Transforms a layer from the robot's frame to the arena's frame.
Layer placed(Layer layer, const RobotPose& robot) {
  const double x = layer.x;
  const double y = layer.y;
  const double cosine = std::cos(robot.theta);
  const double sine = std::sin(robot.theta);
  layer.x = robot.x + cosine * x - sine * y;
  layer.y = robot.y + sine * x + cosine * y;
  layer.angle = wrapAngle(layer.angle + robot.theta);
  return layer;
}

bool isInside(const Drive& drive, const RobotPose& robot) {
  return std::hypot(robot.x - drive.gate_x, robot.y - drive.gate_y) <= drive.gate_radius;
}

RobotPose poseAt(const Drive& drive, const Track& track, const FrameTimes& times) {
  return drive.predict ? track.predicted(times.shown) : track.last();
}

bool isLost(const Drive& drive, const Track* track, std::int64_t decided) {
  return track == nullptr || seconds(decided - track->lastUtime()) > drive.stale;
}

/// Whether this robot opens the gate if it is at `pose`.
bool opens(const Drive& drive, std::int32_t id, const RobotPose& pose, std::int64_t utime,
           const RobotTracks& robots) {
  switch (drive.gate) {
    case Gate::kProgram:
      return robots.runs(id, drive.gate_program, utime, drive.stale);
    case Gate::kInside:
      return isInside(drive, pose);
    case Gate::kOutside:
      return !isInside(drive, pose);
    case Gate::kOpen:
      break;
  }
  return true;
}

/// Whether this robot opens the gate at its tracked pose.
bool opens(const Drive& drive, std::int32_t id, const FrameTimes& times,
           const RobotTracks& robots) {
  if (drive.gate == Gate::kOpen || drive.gate == Gate::kProgram) {
    return opens(drive, id, RobotPose{}, times.decided, robots);
  }
  const Track* track = robots.track(id);
  return !isLost(drive, track, times.decided) &&
         opens(drive, id, poseAt(drive, *track, times), times.decided, robots);
}

std::size_t layerBytes(const Layer& layer) {
  const std::size_t grid =
      layer.kind == LayerKind::kGrid && layer.pixels ? layer.pixels->grey.size() : 0;
  return kLayerBytes + grid + (layer.kind == LayerKind::kImage ? kDigestBytes : 0);
}

std::optional<std::string> driveProblem(const DrivenLayer& layer,
                                        const SceneContext& scene_context) {
  const Drive& drive = layer.drive;
  if (auto problem = light::validate(drive, layer.layer.kind)) return problem;
  for (const std::string& image : drive.images) {
    if (!scene_context.images.contains(image)) {
      return "images = " + image.substr(0, 80) + ", allowed: the SHA-256 of images loaded here";
    }
  }
  if (drive.gate == Gate::kProgram && !scene_context.programs.empty() &&
      std::ranges::find(scene_context.programs, drive.gate_program) ==
          scene_context.programs.end()) {
    return "gate_program = \"" + drive.gate_program.substr(0, 80) +
           "\", allowed: a program of the experiment";
  }
  return {};
}

}  // namespace

std::optional<std::string> Scene::problem(const std::vector<DrivenLayer>& layers,
                                          const SceneContext& scene_context) {
  if (layers.size() > light::kMostLayers) {
    const std::string most = std::to_string(light::kMostLayers);
    return "layers = more than " + most + " layers, allowed: at most " + most;
  }
  std::vector<Layer> plain;
  for (const DrivenLayer& layer : layers) plain.push_back(layer.layer);
  if (auto problem = light::validate(plain)) return problem;
  std::size_t copies = 0;
  std::size_t bytes = 0;
  bool trail = false;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const auto named = [i](const std::string& what) {
      return "layers[" + std::to_string(i) + "]." + what;
    };
    if (layers[i].layer.kind == LayerKind::kFade) {
      return named("kind = 10, allowed in a command: any but 10");
    }
    if (const auto problem = driveProblem(layers[i], scene_context)) return named(*problem);
    const Drive& drive = layers[i].drive;
    const std::vector<std::int32_t>& ids =
        drive.robots.empty() ? scene_context.robots : drive.robots;
    const std::size_t most = drive.follow == Follow::kRobots ? ids.size() : 1;
    copies += most;
    bytes += most * layerBytes(layers[i].layer);
    trail = trail || drive.follow == Follow::kTrail;
  }
  if (trail) bytes += kMostTrailCells;
  if (copies > kMostResolved) {
    return "layers = " + std::to_string(copies) + " layers with a copy for each robot followed, " +
           "allowed: at most " + std::to_string(kMostResolved);
  }
  if (bytes > kMostBytes) {
    return "layers = " + std::to_string(bytes) + " bytes of LIGHT_STATUS, allowed: at most " +
           std::to_string(kMostBytes) + "; a trail takes " + std::to_string(kMostTrailCells);
  }
  return {};
}

std::size_t Scene::bytesOf(const std::vector<Layer>& layers) {
  std::size_t bytes = 0;
  for (const Layer& layer : layers) bytes += layerBytes(layer);
  return bytes;
}

Scene::Scene(std::vector<DrivenLayer> layers, std::int64_t from_utime,
             const SceneContext& scene_context)
    : from_utime_(from_utime), scene_context_(&scene_context) {
  const auto trails = static_cast<std::size_t>(std::ranges::count_if(
      layers, [](const DrivenLayer& layer) { return layer.drive.follow == Follow::kTrail; }));
  for (DrivenLayer& layer : layers) {
    Entry& entry = entries_.emplace_back();
    entry.driven = std::move(layer);
    const Drive& drive = entry.driven.drive;
    entry.still = light::isStill(drive);
    still_ = still_ && entry.still;
    needs_poses_ = needs_poses_ || drive.follow != Follow::kNothing ||
                   drive.gate == Gate::kInside || drive.gate == Gate::kOutside;
    if (drive.follow == Follow::kTrail) {
      entry.trail.emplace(Trail::Settings{.width = scene_context.arena_width,
                                          .height = scene_context.arena_height,
                                          .most_cells = kMostTrailCells / trails,
                                          .radius = entry.driven.layer.size,
                                          .rate = drive.rate,
                                          .decay = drive.decay,
                                          .diffusion = drive.diffusion});
    }
  }
}

Scene::Scene(const std::vector<Layer>& layers) {
  for (const Layer& layer : layers) entries_.emplace_back().driven.layer = layer;
}

const std::vector<std::int32_t>& Scene::followed(const Drive& drive) const {
  return drive.robots.empty() ? scene_context_->robots : drive.robots;
}

void Scene::addFrame(const ObservedFrame& frame, const RobotTracks& robots) {
  for (Entry& entry : entries_) {
    if (!entry.trail || frame.utime < from_utime_) continue;
    const Drive& drive = entry.driven.drive;
    const FrameTimes times{frame.utime, frame.utime};
    entry.trail->advanceTo(frame.utime);
    if (drive.gate_robot != 0 && !opens(drive, drive.gate_robot, times, robots)) continue;
    for (const std::int32_t id : followed(drive)) {
      const Track* track = robots.track(id);
      if (track == nullptr || track->lastUtime() != frame.utime || !track->joined()) continue;
      std::int64_t& laid = entry.laid[id];
      if (laid >= frame.utime) continue;
      laid = frame.utime;
      const bool known = track->beforeUtime() >= from_utime_ &&
                         seconds(frame.utime - track->beforeUtime()) <= drive.stale;
      if (!known) continue;
      const RobotPose from = track->before();
      const RobotPose to = track->last();
      if (drive.gate_robot == 0 && !opens(drive, id, to, frame.utime, robots)) continue;
      entry.trail->lay(from.x, from.y, track->beforeUtime(), to.x, to.y, frame.utime);
    }
  }
}

bool Scene::isOpen(const Drive& drive, const FrameTimes& times, const RobotTracks& robots) const {
  if (drive.gate == Gate::kOpen) return true;
  if (drive.gate_robot != 0) return opens(drive, drive.gate_robot, times, robots);
  return std::ranges::any_of(scene_context_->robots,
                             [&](std::int32_t id) { return opens(drive, id, times, robots); });
}

bool Scene::noteLost(const Drive& drive, std::int32_t id, const Track* track,
                     const FrameTimes& times) {
  if (!isLost(drive, track, times.decided)) return false;
  lost_[id] = track != nullptr ? track->lastUtime() : 0;
  if (drive.when_lost == light::WhenLost::kSafe) picture_.safe = true;
  return true;
}

void Scene::placeCopies(const Entry& entry, const Layer& layer, const FrameTimes& times,
                        const RobotTracks& robots) {
  const Drive& drive = entry.driven.drive;
  for (const std::int32_t id : followed(drive)) {
    const Track* track = robots.track(id);
    const bool lost = noteLost(drive, id, track, times);
    if (lost && (track == nullptr || drive.when_lost != light::WhenLost::kHold)) continue;
    const RobotPose pose = lost ? track->last() : poseAt(drive, *track, times);
    const bool open = drive.gate_robot != 0 ? opens(drive, drive.gate_robot, times, robots)
                                            : opens(drive, id, pose, times.decided, robots);
    if (open) picture_.layers.push_back(placed(layer, pose));
  }
}

void Scene::pushTrail(Entry& entry, const Layer& layer, const FrameTimes& times,
                      const RobotTracks& robots) {
  const Drive& drive = entry.driven.drive;
  for (const std::int32_t id : followed(drive)) noteLost(drive, id, robots.track(id), times);
  Trail& trail = *entry.trail;
  Layer grid;
  grid.kind = LayerKind::kGrid;
  grid.blend = layer.blend;
  grid.size = trail.columns() * trail.cell();
  grid.inner = trail.rows() * trail.cell();
  grid.x = grid.size / 2;
  grid.y = grid.inner / 2;
  grid.intensity = layer.intensity;
  grid.intensity2 = layer.intensity2;
  const std::int64_t utime = times.trails != 0 ? times.trails : times.shown;
  grid.pixels = trail.picture(utime);
  grid.seed = static_cast<std::uint64_t>(utime);
  picture_.layers.push_back(std::move(grid));
}

void Scene::resolve(Entry& entry, const FrameTimes& times, const RobotTracks& robots) {
  if (entry.still) {
    picture_.layers.push_back(entry.driven.layer);
    return;
  }
  const Drive& drive = entry.driven.drive;
  Layer layer = light::driven(entry.driven, seconds(times.shown - from_utime_));
  if (!layer.image.empty() && !layer.pixels) {
    const auto found = scene_context_->images.find(layer.image);
    if (found != scene_context_->images.end()) layer.pixels = found->second;
  }
  switch (drive.follow) {
    case Follow::kNothing:
      if (isOpen(drive, times, robots)) picture_.layers.push_back(std::move(layer));
      break;
    case Follow::kRobots:
      placeCopies(entry, layer, times, robots);
      break;
    case Follow::kTrail:
      pushTrail(entry, layer, times, robots);
      break;
  }
}

const Scene::Picture& Scene::at(const FrameTimes& times, const RobotTracks& robots) {
  if (still_ && resolved_) return picture_;
  resolved_ = true;
  picture_.layers.clear();
  picture_.safe = false;
  lost_.clear();
  for (Entry& entry : entries_) resolve(entry, times, robots);
  picture_.trouble = troubleText(lost_, picture_.safe);
  return picture_;
}

}  // namespace lab::projector
