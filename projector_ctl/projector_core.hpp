/// Decides which command controls the light and what is shown, without bus, clock or display.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "light/field/field.hpp"
#include "projector_ctl/scene.hpp"

namespace lab::projector {

/// The complete light field that one sender commands. Utimes are microseconds since 1970.
struct LightCommand {
  std::string sender{};
  std::int64_t instance = 0;          ///< new at each start of the sender
  std::int64_t seq = 0;               ///< increases with each new command, equal in repetitions
  std::int32_t priority = 0;          ///< the command with the highest priority controls the light
  std::int64_t from_utime = 0;        ///< start time; past or 0: at once
  double ramp = 0;                    ///< [s] duration of the cross-fade from the previous field
  std::int64_t hold_until_utime = 0;  ///< valid until then without repetition; 0: needs repetition
  bool release = false;               ///< the sender gives up control; `layers` is ignored
  std::string label{};                ///< for display to the user
  std::vector<light::DrivenLayer> layers{};  ///< the time of the layers is 0 at from_utime
};

/// Result of a command.
enum class Verdict : std::int8_t {
  kAccepted = 1,  ///< new, and in force now or from its from_utime on
  kRepeated = 2,  ///< known; shows that its sender is alive
  kStale = 3,     ///< ignored: older than another command, or from a replaced instance
  kRefused = 4,   ///< invalid; nothing changed
};

struct [[nodiscard]] Answer {
  Verdict verdict = Verdict::kAccepted;
  std::string reason{};  ///< for a refusal: what was found, what is allowed
};

/// One displayed frame.
struct ShownFrame {
  light::Field field{};
  bool changed = false;       ///< field, command or trouble differ from those of the last frame
  bool moving = false;        ///< during a cross-fade, or if layers change by themselves
  std::string commander{};    ///< empty: the safe field
  std::int64_t instance = 0;  ///< of the commander, 0 for the safe field
  std::int64_t seq = 0;       ///< of the command, 0 for the safe field
  std::string label{};        ///< of the command; for the safe field, the reason
  std::int64_t frame = 0;     ///< number of the frame, from 1
  std::int64_t presentation_utime = 0;  ///< when this frame is on the arena
  std::int64_t first_shown_utime = 0;   ///< when the first frame of this command was on the arena
  int sync = -1;                        ///< the sync patch: 0 dark, 1 bright, -1 none
  std::string trouble{};                ///< why the field differs from the commanded one
  std::int64_t tracker_instance = 0;    ///< tracker whose poses are used; 0: none
  /// Numbers of the camera frames whose poses are used since the previous frame. If poses were not
  /// needed before, these are all frames of the last 0.3 s.
  std::vector<std::int64_t> tracked_frames{};
};

/// Arbitrates between commands and computes the field of each frame.
///
/// Only the latest command of each sender is considered, of at most kMostSenders: a new one takes
/// the place of the sender without a command that was silent for longest, or is refused. The sender
/// with the highest priority controls the light; among equals, the one whose command came into
/// force last. A command with hold_until_utime is valid until then; one without is valid while its
/// sender repeats it at least every command_timeout. When the controlling command ends, the sender
/// with the next priority takes over; without any command the safe field is shown.
///
/// The result depends only on the given utimes, not on the times of the frames. A cross-fade starts
/// when its command comes into force (at its from_utime, or at its arrival if that is later), from
/// the field shown at that time. After a release or the end of a hold, the field that returns fades
/// in over the ramp of the command that ended. The end by timeout has no ramp.
///
/// Layers that change by themselves (scene.hpp) are resolved for each frame, for the time at which
/// the frame is on the arena. A cross-fade resolves both of its fields; if it is interrupted, its
/// present state is frozen as the start of the next one. A scene begins when its command first
/// controls the light, and exists as long as the command: its trails continue while another command
/// controls the light.
class ProjectorCore {
 public:
  struct Config {
    std::vector<light::Layer> safe_field{light::Layer{}};
    double command_timeout = 2.5;  ///< [s]
    SceneContext scene_context{};
    double latency = 0;     ///< [s] from a frame's decision to its light
    double sync_patch = 0;  ///< [m] side of the square at the origin whose brightness toggles with
                            ///< each command and every kSyncPeriod, so that a camera can find it
  };

  static constexpr double kSyncPeriod = 0.5;           ///< [s] between toggles of the sync patch
  static constexpr double kLongestRamp = 3600;         ///< [s]
  static constexpr double kFurthestStart = 24 * 3600;  ///< [s] from arrival to from_utime, at most
  static constexpr std::size_t kMostScheduled = 16;    ///< pending commands of one sender
  static constexpr std::size_t kMostSenders = 64;      ///< far more than a lab has

  /// @throws std::invalid_argument if the safe field is invalid or the timeout is not above 0.
  explicit ProjectorCore(Config config);

  /// Processes a command that arrived at `received_utime`. Its image layers must have their pixels.
  Answer apply(const LightCommand& command, std::int64_t received_utime);

  /// Adds a camera frame for the next picture. Only the frames of one tracker are used at a time;
  /// those of another tracker replace them.
  void addFrame(ObservedFrame frame);

  /// Stores the program that a robot reports.
  void report(std::int32_t robot, const std::string& program, std::int64_t utime) {
    robots_.report(robot, program, utime);
  }

  /// The frame decided at `decided_utime`, valid until the next call. Calls must be in order of
  /// time, after all earlier input.
  const ShownFrame& frame(std::int64_t decided_utime) {
    return frame(decided_utime, decided_utime + latency_us_);
  }

  /// The same for a frame whose light is expected on the arena at `shown_utime`.
  const ShownFrame& frame(std::int64_t decided_utime, std::int64_t shown_utime);

 private:
  struct Accepted : LightCommand {
    std::int64_t origin_utime = 0;  ///< at this utime the time of its layers is 0
  };

  struct Sender {
    std::int64_t instance = 0;
    std::vector<std::int64_t> replaced;  ///< earlier instances of this sender
    std::int64_t newest_seq = 0;
    std::int64_t heard_utime = 0;
    std::optional<Accepted> active;
    std::int64_t active_since = 0;
    std::shared_ptr<Scene> scene;     ///< of the active command, once it has controlled the light
    std::vector<Accepted> scheduled;  ///< in order of from_utime
  };

  [[nodiscard]] std::optional<std::string> problem(const LightCommand& command,
                                                   std::int64_t received_utime) const;
  [[nodiscard]] std::int64_t endOf(const Sender& sender) const;
  [[nodiscard]] bool isValid(const Sender& sender) const {
    return sender.active && now_ < endOf(sender);
  }
  [[nodiscard]] bool makeRoom();
  [[nodiscard]] Sender* commander();
  [[nodiscard]] bool isFading(std::int64_t utime) const { return utime - ramp_start_ < ramp_us_; }

  void advance(std::int64_t utime);
  void bringIntoForce(Sender& sender);
  void chooseCommander();
  void startRamp(std::shared_ptr<Scene> scene, double ramp);
  light::Field fieldAt(const FrameTimes& times);
  const std::vector<light::Layer>& layersOf(Scene& scene, const FrameTimes& times);
  [[nodiscard]] std::vector<Scene*> scenes() const;
  void useWaitingFrames();

  Config config_;
  std::int64_t timeout_us_;
  std::int64_t latency_us_;
  std::map<std::string, Sender> senders_;
  RobotTracks robots_;
  std::vector<ObservedFrame> waiting_;  ///< for the next picture

  std::int64_t now_ = 0;     ///< all events up to this time are processed
  double leaving_ramp_ = 0;  ///< [s] ramp of the command that lost control last
  std::optional<LightCommand> commanding_;
  std::string safe_label_;
  std::shared_ptr<Scene> safe_;

  std::shared_ptr<Scene> target_;
  std::shared_ptr<Scene> previous_;  ///< the start of a cross-fade
  std::int64_t ramp_start_ = 0;
  std::int64_t ramp_us_ = 0;
  std::int64_t version_ = 0;  ///< counts changes of command or target
  std::string trouble_;       ///< of the last resolved field
  light::Layer sync_layer_;
  std::int64_t sync_turn_ = 0;  ///< utime of the last toggle of the sync patch

  ShownFrame shown_;
  std::int64_t shown_version_ = -1;
};

}  // namespace lab::projector
