/// What one command shows: layers that change with time and with the robots, resolved to layers
/// that anybody can evaluate.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "light/field/drive.hpp"
#include "light/field/image.hpp"
#include "projector_ctl/scene/prediction.hpp"
#include "projector_ctl/scene/trail.hpp"

namespace lab::projector {

/// What scenes need to know of the experiment.
struct SceneContext {
  double arena_width = 1.2;             ///< [m]
  double arena_height = 0.9;            ///< [m]
  std::vector<std::int32_t> robots{};   ///< those meant by "every robot"
  std::vector<std::string> programs{};  ///< names that a gate may ask for; empty: any
  light::ImageStore images{};           ///< of sequences
};

/// The two times of a frame [us since 1970].
struct FrameTimes {
  std::int64_t decided = 0;  ///< what had arrived until then is in the picture
  std::int64_t shown = 0;    ///< when it is on the arena
  std::int64_t trails = 0;   ///< that trails are worked out for; 0: `shown`
};

/// Pure: the same layers, frames and reports, in the same order, give the same picture at the same
/// moment, however often and when it was asked for others before. The grid of a trail has in its
/// `seed`, which a grid does not read, the moment [us since 1970] that it is for.
class Scene {
 public:
  /// Both lists of a LIGHT_STATUS at this size stay below the 60 KB of a message.
  static constexpr std::size_t kMostBytes = 29'000;
  /// The layers of a picture, copies counted; one more is left for the sync patch.
  static constexpr std::size_t kMostResolved = light::kMostLayers - 1;

  struct Picture {
    std::vector<light::Layer> layers{};
    bool safe = false;      ///< the safe field is to be shown instead: who is followed is lost
    std::string trouble{};  ///< who is lost, empty: nobody
  };

  /// Why the layers cannot be a command's, as "layers[i].field = found, allowed: ...", or nothing.
  [[nodiscard]] static std::optional<std::string> problem(
      const std::vector<light::DrivenLayer>& layers, const SceneContext& scene_context);

  /// What the layers take of a LIGHT_STATUS, or a little more.
  [[nodiscard]] static std::size_t bytesOf(const std::vector<light::Layer>& layers);

  /// @param layers without a problem()
  /// @param from_utime when their time was 0 [us since 1970]
  /// @param scene_context outlive the scene
  Scene(std::vector<light::DrivenLayer> layers, std::int64_t from_utime,
        const SceneContext& scene_context);

  /// Layers that nothing changes.
  explicit Scene(const std::vector<light::Layer>& layers);

  /// Whether every moment's picture is the same.
  [[nodiscard]] bool isStill() const { return still_; }

  /// Whether the picture depends on where robots are.
  [[nodiscard]] bool needsPoses() const { return needs_poses_; }

  /// Takes a frame that `robots` has just taken; trails grow. Frames from before from_utime leave
  /// no trail.
  void take(const ObservedFrame& frame, const RobotTracks& robots);

  /// Valid until the next call.
  const Picture& at(const FrameTimes& moment, const RobotTracks& robots);

 private:
  struct Entry {
    light::DrivenLayer driven;
    bool still = true;
    std::optional<Trail> trail{};
    std::map<std::int32_t, std::int64_t> laid{};  ///< by robot: until when
  };

  [[nodiscard]] const std::vector<std::int32_t>& followed(const light::Drive& drive) const;
  [[nodiscard]] bool isOpen(const light::Drive& drive, const FrameTimes& moment,
                            const RobotTracks& robots) const;
  void resolve(Entry& entry, const FrameTimes& moment, const RobotTracks& robots);
  void placeCopies(const Entry& entry, const light::Layer& layer, const FrameTimes& moment,
                   const RobotTracks& robots);
  void pushTrail(Entry& entry, const light::Layer& layer, const FrameTimes& moment,
                 const RobotTracks& robots);
  bool noteLost(const light::Drive& drive, std::int32_t id, const Track* track,
                const FrameTimes& moment);

  std::vector<Entry> entries_;
  std::int64_t from_utime_ = 0;
  const SceneContext* scene_context_ = nullptr;
  bool still_ = true;
  bool needs_poses_ = false;
  bool resolved_ = false;                      ///< a still scene is resolved once
  std::map<std::int32_t, std::int64_t> lost_;  ///< since when they were not seen; 0: never seen
  Picture picture_;
};

}  // namespace lab::projector
