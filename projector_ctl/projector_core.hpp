/// Who commands the light, and what is shown when: the projector without bus, clock and display.
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

/// The whole field that one sender wants. Utimes are microseconds since 1970.
struct LightCommand {
  std::string sender{};
  std::int64_t instance = 0;    ///< new at each start of the sender
  std::int64_t seq = 0;         ///< rises with each new command, unchanged while it is repeated
  std::int32_t priority = 0;    ///< the highest commands the light
  std::int64_t from_utime = 0;  ///< in force from then on; past or 0: at once
  double ramp = 0;              ///< [s] length of the cross-fade from what is shown then
  std::int64_t hold_until_utime = 0;  ///< in force until then without repetition, 0: repeat it
  bool release = false;               ///< the sender gives the light back; `layers` is not read
  std::string label{};                ///< for people
  std::vector<light::DrivenLayer> layers{};  ///< their time is 0 at from_utime
};

/// What became of a command.
enum class Verdict : std::int8_t {
  kAccepted = 1,  ///< new, and in force now or from its from_utime on
  kRepeated = 2,  ///< known; its sender is alive
  kStale = 3,     ///< older than one already taken, or of an instance that was replaced: ignored
  kRefused = 4,   ///< invalid: nothing changed
};

struct [[nodiscard]] Answer {
  Verdict verdict = Verdict::kAccepted;
  std::string reason{};  ///< of a refusal: what was found, what is allowed
};

/// One displayed frame.
struct ShownFrame {
  light::Field field{};
  bool changed = false;       ///< field, command or trouble differ from the last frame's
  bool moving = false;        ///< a cross-fade is under way, or layers change by themselves
  std::string commander{};    ///< empty: the safe field
  std::int64_t instance = 0;  ///< of the commander, 0 for the safe field
  std::int64_t seq = 0;       ///< of the command, 0 for the safe field
  std::string label{};        ///< of the command; for the safe field, why it is shown
  std::int64_t frame = 0;     ///< counts frames from 1
  std::int64_t presentation_utime = 0;  ///< of this frame: when it is on the arena
  std::int64_t first_shown_utime = 0;   ///< of the first frame that showed this command
  int sync = -1;                        ///< the sync patch: 0 dark, 1 bright, -1: there is none
  std::string trouble{};                ///< why something else than wanted is shown
  std::int64_t tracker_instance = 0;    ///< whose poses are in use, 0: nobody's
  std::vector<std::int64_t> tracked_frames{};  ///< that entered since the frame before; where poses
                                               ///< come into use, those still remembered
};

/// Resolves commands to a field.
///
/// Of every sender the latest command counts; among the senders the highest priority commands, and
/// among equals the one whose command came into force last. A command with hold_until_utime stands
/// until then; one without stands while its sender repeats it at least every command_timeout. When
/// a commander's say ends, the next in priority returns, and with nobody left the safe field is
/// shown.
///
/// Everything is a function of the utimes given, not of when frames fall: a cross-fade starts at
/// the moment its command comes into force (its from_utime, or its arrival when that is later),
/// from the field shown at that moment, and what comes back after a release or a hold fades in over
/// the ramp of the command that went. What silence ends, ends at once.
///
/// What changes by itself (scene.hpp) is resolved frame by frame, for the moment the frame is on
/// the arena; a cross-fade resolves both its ends, and one that is interrupted freezes as it then
/// is. A
/// scene begins when its command first commands, and lives as long as the command: a trail goes on
/// being laid while another command covers it.
class ProjectorCore {
 public:
  struct Config {
    std::vector<light::Layer> safe_field{light::Layer{}};
    double command_timeout = 2.5;  ///< [s]
    SceneContext scene_context{};
    double latency = 0;     ///< [s] from a frame's decision to its light
    double sync_patch = 0;  ///< [m] side of the square at the origin that turns with each command,
                            ///< and every kSyncPeriod, so that a camera learns where it is
  };

  static constexpr double kSyncPeriod = 0.5;           ///< [s] between turns of the sync patch
  static constexpr double kLongestRamp = 3600;         ///< [s]
  static constexpr double kFurthestStart = 24 * 3600;  ///< [s] of from_utime after arrival
  static constexpr std::size_t kMostScheduled = 16;    ///< commands of one sender not yet in force

  /// @throws std::invalid_argument when the safe field cannot be painted or the timeout is not
  /// above 0.
  explicit ProjectorCore(Config config);

  /// Takes a command that arrived at `received_utime`. Its image layers must have their pixels.
  Answer apply(const LightCommand& command, std::int64_t received_utime);

  /// Takes a camera frame: it enters the next picture. Frames of one tracker enter at a time; those
  /// of another one replace them.
  void take(ObservedFrame frame);

  /// The program that a robot says it runs.
  void report(std::int32_t robot, const std::string& program, std::int64_t utime) {
    robots_.report(robot, program, utime);
  }

  /// The frame decided at `decided_utime`, valid until the next call. Call it in order of time,
  /// with everything that arrived before already taken.
  const ShownFrame& frame(std::int64_t decided_utime) {
    return frame(decided_utime, decided_utime + latency_us_);
  }

  /// The same for a frame whose light is expected on the arena at `shown_utime`.
  const ShownFrame& frame(std::int64_t decided_utime, std::int64_t shown_utime);

 private:
  struct Accepted : LightCommand {
    std::int64_t origin_utime = 0;  ///< of its layers' time
  };

  struct Sender {
    std::int64_t instance = 0;
    std::vector<std::int64_t> replaced;  ///< instances
    std::int64_t newest_seq = 0;
    std::int64_t heard_utime = 0;
    std::optional<Accepted> active;
    std::int64_t active_since = 0;
    std::shared_ptr<Scene> scene;     ///< of the active command, once it commanded
    std::vector<Accepted> scheduled;  ///< by from_utime
  };

  [[nodiscard]] std::optional<std::string> problem(const LightCommand& command,
                                                   std::int64_t received_utime) const;
  [[nodiscard]] std::int64_t endOf(const Sender& sender) const;
  [[nodiscard]] Sender* commander();
  [[nodiscard]] bool isFading(std::int64_t utime) const { return utime - ramp_start_ < ramp_us_; }

  void advance(std::int64_t utime);
  void bringIntoForce(Sender& sender);
  void chooseCommander();
  void startRamp(std::shared_ptr<Scene> scene, double ramp);
  light::Field fieldAt(const FrameTimes& moment);
  const std::vector<light::Layer>& layersOf(Scene& scene, const FrameTimes& moment);
  [[nodiscard]] std::vector<Scene*> scenes() const;
  void takeFrames();

  Config config_;
  std::int64_t timeout_us_;
  std::int64_t latency_us_;
  std::map<std::string, Sender> senders_;
  RobotTracks robots_;
  std::vector<ObservedFrame> waiting_;  ///< for the next picture

  std::int64_t now_ = 0;     ///< everything up to here has happened
  double leaving_ramp_ = 0;  ///< [s] of the command that gave way last
  std::optional<LightCommand> commanding_;
  std::string safe_label_;
  std::shared_ptr<Scene> safe_;

  std::shared_ptr<Scene> target_;
  std::shared_ptr<Scene> previous_;  ///< what a cross-fade comes from
  std::int64_t ramp_start_ = 0;
  std::int64_t ramp_us_ = 0;
  std::int64_t version_ = 0;  ///< counts changes of command or target
  std::string trouble_;       ///< of what was resolved last
  light::Layer sync_layer_;
  std::int64_t sync_turn_ = 0;  ///< utime of its last turn

  ShownFrame shown_;
  std::int64_t shown_version_ = -1;
};

}  // namespace lab::projector
