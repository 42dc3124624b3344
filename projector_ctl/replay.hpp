/// The light of a log, worked out again from what went into it.
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

/// What a LIGHT_STATUS says of its picture, beside the layers.
struct ShownRecord {
  std::int64_t projector = 0;  ///< instance of the projector
  std::int64_t utime = 0;
  double latency = 0;       ///< [s]
  std::string commander{};  ///< empty: the safe field
  std::int64_t command_instance = 0;
  std::int64_t command_seq = 0;
  std::int64_t tracker_instance = 0;
  std::vector<std::int64_t> tracked_frames{};
  std::vector<light::Layer> layers{};  ///< as shown; read for the moments of trails
};

/// Give it commands, camera frames and reports in the log's order, and every LIGHT_STATUS: it says
/// what each must have shown. What is gated by programs depends on ROBOT_STATUS too, of which no
/// status says what had arrived: in a live run a frame may differ where the two crossed.
class Replay {
 public:
  /// @param scene_context as the projector had them; outlive this
  explicit Replay(const SceneContext& scene_context) : scene_context_(scene_context) {}

  /// As the projector took it: with a from_utime.
  void take(const LightCommand& command);
  void take(ObservedFrame frame);
  void report(std::int32_t robot, const std::string& program, std::int64_t utime) {
    robots_.report(robot, program, utime);
  }

  /// The layers of this status, without a sync patch. Nothing where it cannot be said: the safe
  /// field, a command or a frame that the log does not have.
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
