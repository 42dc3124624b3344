#include "projector_ctl/replay.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lab::projector {
namespace {

constexpr std::size_t kMostFrames = 4000;  // camera frames kept until a status names them

/// The time that the trails of a status were computed for. It differs from the status' time if the
/// display showed the frame earlier or later than expected. 0: there are no trails.
std::int64_t trailMomentOf(const ShownRecord& status) {
  for (const light::Layer& layer : status.layers) {
    if (layer.kind == light::LayerKind::kGrid && layer.seed != 0) {
      return static_cast<std::int64_t>(layer.seed);
    }
  }
  return 0;
}

}  // namespace

void Replay::add(const LightCommand& command) {
  commands_.try_emplace({command.sender, command.instance, command.seq}, command);
}

void Replay::add(ObservedFrame frame) {
  const std::pair key{frame.instance, frame.number};
  frames_.insert_or_assign(key, std::move(frame));
  if (frames_.size() <= kMostFrames) return;
  const auto oldest =
      std::ranges::min_element(frames_, {}, [](const auto& entry) { return entry.second.utime; });
  frames_.erase(oldest);
}

/// @return whether all camera frames were available
bool Replay::play(const ShownRecord& status) {
  bool complete = true;
  if (status.tracker_instance == 0) robots_.forgetPoses();
  for (const std::int64_t number : status.tracked_frames) {
    const auto frame = frames_.find({status.tracker_instance, number});
    if (frame == frames_.end()) {
      complete = false;
      continue;
    }
    robots_.add(frame->second);
    for (auto& [key, played] : scenes_) played.scene->addFrame(frame->second, robots_);
    frames_.erase(frame);
  }
  return complete;
}

std::optional<std::vector<light::Layer>> Replay::layersOf(const ShownRecord& status) {
  if (status.projector != projector_) {
    scenes_.clear();
    robots_ = RobotTracks(scene_context_.robots);
    projector_ = status.projector;
  }
  const Key key{status.commander, status.command_instance, status.command_seq};
  const auto command = commands_.find(key);
  if (command != commands_.end() && !scenes_.contains(key)) {
    // The sender's previous command may still fade out; older ones are no longer needed.
    std::erase_if(scenes_, [&](const auto& entry) {
      return std::get<0>(entry.first) == status.commander &&
             std::get<2>(entry.first) + 1 < status.command_seq;
    });
    scenes_[key].scene =
        std::make_unique<Scene>(command->second.layers, command->second.from_utime, scene_context_);
  }
  if (!play(status)) {
    for (auto& [known, played] : scenes_) played.complete = !played.scene->needsPoses();
  }
  const auto played = scenes_.find(key);
  if (played == scenes_.end() || !played->second.complete) return {};
  const std::int64_t decided = status.utime - std::llround(status.latency * 1e6);
  const Scene::Picture& picture =
      played->second.scene->at({decided, status.utime, trailMomentOf(status)}, robots_);
  if (picture.safe) return {};
  return picture.layers;
}

}  // namespace lab::projector
