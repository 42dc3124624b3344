/// Who commands the light, and what is shown when: the projector without bus, clock and display.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "light/field.hpp"

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
  std::vector<light::Layer> layers{};
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
struct Shown {
  light::Field field{};
  bool changed = false;                 ///< field or command differ from the last frame's
  bool moving = false;                  ///< a cross-fade is under way
  std::string commander{};              ///< empty: the safe field
  std::int64_t instance = 0;            ///< of the commander, 0 for the safe field
  std::int64_t seq = 0;                 ///< of the command, 0 for the safe field
  std::string label{};                  ///< of the command; for the safe field, why it is shown
  std::int64_t frame = 0;               ///< counts frames from 1
  std::int64_t presentation_utime = 0;  ///< of this frame
  std::int64_t first_shown_utime = 0;   ///< of the first frame that showed this command
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
class ProjectorCore {
 public:
  struct Config {
    std::vector<light::Layer> safe_field{light::Layer{}};
    double command_timeout = 2.5;  ///< [s]
  };

  static constexpr double kLongestRamp = 3600;         ///< [s]
  static constexpr double kFurthestStart = 24 * 3600;  ///< [s] of from_utime after arrival
  static constexpr std::size_t kMostScheduled = 16;    ///< commands of one sender not yet in force

  /// @throws std::invalid_argument when the safe field cannot be painted or the timeout is not
  /// above 0.
  explicit ProjectorCore(Config config);

  /// Takes a command that arrived at `received_utime`. Its image layers must have their pixels.
  Answer apply(const LightCommand& command, std::int64_t received_utime);

  /// The frame presented at `presentation_utime`, valid until the next call. Call it in order of
  /// time, with every command that arrived before already applied.
  const Shown& frame(std::int64_t presentation_utime);

 private:
  struct Sender {
    std::int64_t instance = 0;
    std::vector<std::int64_t> replaced;  ///< instances
    std::int64_t newest_seq = 0;
    std::int64_t heard_utime = 0;
    std::optional<LightCommand> active;
    std::int64_t active_since = 0;
    std::vector<LightCommand> scheduled;  ///< by from_utime
  };

  [[nodiscard]] std::optional<std::string> problem(const LightCommand& command,
                                                   std::int64_t received_utime) const;
  [[nodiscard]] std::int64_t endOf(const Sender& sender) const;
  [[nodiscard]] const Sender* commander() const;
  [[nodiscard]] light::Field fieldAt(std::int64_t utime) const;

  void advance(std::int64_t utime);
  void bringIntoForce(Sender& sender);
  void chooseCommander();
  void startRamp(const std::vector<light::Layer>& layers, double ramp);

  Config config_;
  std::int64_t timeout_us_;
  std::map<std::string, Sender> senders_;

  std::int64_t now_ = 0;     ///< everything up to here has happened
  double leaving_ramp_ = 0;  ///< [s] of the command that gave way last
  std::optional<LightCommand> commanding_;
  std::string safe_label_;

  light::Field field_;  ///< its mix is that of ramp_start_
  std::int64_t ramp_start_ = 0;
  std::int64_t ramp_us_ = 0;
  std::int64_t version_ = 0;  ///< counts changes of command or target

  Shown shown_;
  std::int64_t shown_version_ = -1;
};

}  // namespace lab::projector
