/// Recomputes the light of a log from the projector's inputs.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "projector_ctl/projector_core.hpp"
#include "projector_ctl/scene.hpp"

namespace lab::projector {

/// The fields of a LIGHT_STATUS that identify the inputs of its picture.
struct ShownRecord {
  std::int64_t projector = 0;  ///< instance of the projector
  std::int64_t utime = 0;
  double latency = 0;       ///< [s]
  std::string commander{};  ///< empty: the safe field
  std::int64_t command_instance = 0;
  std::int64_t command_seq = 0;
  std::int64_t tracker_instance = 0;
  std::vector<std::int64_t> tracked_frames{};
  std::vector<light::Layer> layers{};  ///< as shown; used for the times of trails
};

/// Receives commands, camera frames and reports in the order of the log, and computes the layers of
/// every LIGHT_STATUS. Layers that are gated by programs depend on ROBOT_STATUS as well, and
/// LIGHT_STATUS does not tell which of those had arrived. So a frame of a live run may differ if a
/// ROBOT_STATUS arrived at about the time of the frame.
class Replay {
 public:
  /// @param scene_context as in the projector; must outlive this object
  explicit Replay(const SceneContext& scene_context)
      : scene_context_(scene_context), robots_(scene_context.robots) {}

  /// @param command as the projector used it, with a from_utime
  void add(const LightCommand& command);
  void add(ObservedFrame frame);
  void report(std::int32_t robot, const std::string& program, std::int64_t utime) {
    robots_.report(robot, program, utime);
  }

  /// The layers of this status, without a sync patch. Empty for the safe field, or if the command
  /// or a camera frame is missing in the log.
  [[nodiscard]] std::optional<std::vector<light::Layer>> layersOf(const ShownRecord& status);

 private:
  using Key = std::tuple<std::string, std::int64_t, std::int64_t>;
  struct Played {
    std::unique_ptr<Scene> scene;
    bool complete = true;
  };

  bool play(const ShownRecord& status);

  const SceneContext& scene_context_;
  std::map<Key, LightCommand> commands_;
  std::map<std::pair<std::int64_t, std::int64_t>, ObservedFrame>
      frames_;  ///< by tracker and number
  std::map<Key, Played> scenes_;
  RobotTracks robots_;
  std::int64_t projector_ = 0;
};

}  // namespace lab::projector
