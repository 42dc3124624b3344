/// The light of one command: layers that depend on time and robots, resolved into static layers.
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

/// The properties of the experiment that scenes depend on.
struct SceneContext {
  double arena_width = 1.2;             ///< [m]
  double arena_height = 0.9;            ///< [m]
  std::vector<std::int32_t> robots{};   ///< ids of all robots
  std::vector<std::string> programs{};  ///< names that gates may use; empty: any
  light::ImageStore images{};           ///< images of sequences
};

/// The times of a frame [us since 1970].
struct FrameTimes {
  std::int64_t decided = 0;  ///< the picture uses all inputs up to this time
  std::int64_t shown = 0;    ///< when the picture is on the arena
  std::int64_t trails = 0;   ///< time for which trails are computed; 0: `shown`
};

/// The layers of one command. A scene is deterministic: the same layers, camera frames and reports
/// in the same order give the same picture for the same time, whatever other pictures were
/// requested before. A trail becomes a layer of kind kGrid, which does not use `seed`; `seed`
/// contains the time of the trail [us since 1970].
class Scene {
 public:
  /// Two lists of this size in a LIGHT_STATUS stay below the limit of 60 KB per message.
  static constexpr std::size_t kMostBytes = 29'000;
  /// Largest number of layers in a picture, including copies for robots; one is reserved for the
  /// sync patch.
  static constexpr std::size_t kMostResolved = light::kMostLayers - 1;

  struct Picture {
    std::vector<light::Layer> layers{};
    bool safe = false;      ///< show the safe field instead, because a followed robot is lost
    std::string trouble{};  ///< names the lost robots; empty: none
  };

  /// Why the layers are not valid in a command, as "layers[i].field = found, allowed: ..."; empty
  /// if they are valid.
  [[nodiscard]] static std::optional<std::string> problem(
      const std::vector<light::DrivenLayer>& layers, const SceneContext& scene_context);

  /// Upper bound of the size of the layers in a LIGHT_STATUS [bytes].
  [[nodiscard]] static std::size_t bytesOf(const std::vector<light::Layer>& layers);

  /// @param layers must be valid, see problem()
  /// @param from_utime at which the time of the layers was 0 [us since 1970]
  /// @param scene_context must outlive the scene
  Scene(std::vector<light::DrivenLayer> layers, std::int64_t from_utime,
        const SceneContext& scene_context);

  /// A scene of static layers.
  explicit Scene(const std::vector<light::Layer>& layers);

  /// Whether the picture is the same at all times.
  [[nodiscard]] bool isStill() const { return still_; }

  /// Whether the picture depends on poses of robots.
  [[nodiscard]] bool needsPoses() const { return needs_poses_; }

  /// Extends the trails by a camera frame that was just added to `robots`. Frames from before
  /// from_utime are ignored.
  void addFrame(const ObservedFrame& frame, const RobotTracks& robots);

  /// The picture at the times of a frame, valid until the next call.
  const Picture& at(const FrameTimes& times, const RobotTracks& robots);

 private:
  struct Entry {
    light::DrivenLayer driven;
    bool still = true;
    std::optional<Trail> trail{};
    std::map<std::int32_t, std::int64_t> laid{};  ///< by robot: time up to which its trail is laid
  };

  [[nodiscard]] const std::vector<std::int32_t>& followed(const light::Drive& drive) const;
  [[nodiscard]] bool isOpen(const light::Drive& drive, const FrameTimes& times,
                            const RobotTracks& robots) const;
  void resolve(Entry& entry, const FrameTimes& times, const RobotTracks& robots);
  void placeCopies(const Entry& entry, const light::Layer& layer, const FrameTimes& times,
                   const RobotTracks& robots);
  void pushTrail(Entry& entry, const light::Layer& layer, const FrameTimes& times,
                 const RobotTracks& robots);
  bool noteLost(const light::Drive& drive, std::int32_t id, const Track* track,
                const FrameTimes& times);

  std::vector<Entry> entries_;
  std::int64_t from_utime_ = 0;
  const SceneContext* scene_context_ = nullptr;
  bool still_ = true;
  bool needs_poses_ = false;
  bool resolved_ = false;                      ///< a still scene is resolved once
  std::map<std::int32_t, std::int64_t> lost_;  ///< by lost robot: when last seen; 0: never
  Picture picture_;
};

}  // namespace lab::projector
