/// Which step of the light script is shown when: no bus, no clock.
#pragma once

#include <cstddef>
#include <cstdint>
#include <lab/analysis_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <optional>
#include <string>

#include "common/experiment/experiment.hpp"
#include "common/experiment/script_plan.hpp"
#include "runner/script/step_condition.hpp"
#include "runner/script/tumble_count.hpp"

namespace lab::runner {

/// What comes next in a script.
struct ScriptTransition {
  enum class Kind {
    kStep,  ///< a step begins
    kOver,  ///< the script is over, as it should be
    kEnd,   ///< the run ends: a condition was not met
    kSafe,  ///< the same, under the safe light and with robots that stand
  };
  Kind kind = Kind::kStep;
  int number = 0;         ///< of the step, counts from 0 over the whole run
  std::size_t index = 0;  ///< into LightScript::steps
  std::string ended_by;   ///< what ended the step before, empty: its time was up
  std::string fault;      ///< the condition that was not met in time, empty: none

  bool operator==(const ScriptTransition&) const = default;
};

/// Plays a script once: told the time and what the lab sees, it says what comes next. Times are us
/// since 1970.
class ScriptPlayer {
 public:
  /// @param experiment must outlive the player
  explicit ScriptPlayer(const Experiment& experiment)
      : experiment_(experiment), order_(experiment.light) {}

  void begin(std::int64_t utime);

  /// The script's clock stands: no step ends, and what is left of it and of the run stays. What a
  /// step waits for may come about meanwhile; the next one then begins with resume().
  void pause(std::int64_t now);

  /// Everything that is still to come is later by the pause.
  void resume(std::int64_t now);

  [[nodiscard]] bool paused() const { return paused_utime_.has_value(); }

  void take(const tracked_frame_t& frame);
  void take(const robot_status_t& status);
  void take(const analysis_t& analysis);

  /// What has become due, one turn a call; nothing: the step goes on.
  /// A step that its condition ended makes the next one begin `now`; one whose time was up, when it
  /// was up, so that late calls do not add up.
  [[nodiscard]] std::optional<ScriptTransition> turn(std::int64_t now);

  /// When turn() will have something to say at the latest.
  /// Nothing before begin(), in a pause and behind the last turn.
  [[nodiscard]] std::optional<std::int64_t> due() const;

  /// When the run ends at the latest, if no pause follows.
  [[nodiscard]] std::int64_t endUtime() const { return end_utime_; }

  /// [s] of the script since begin(), without pauses.
  [[nodiscard]] double elapsed(std::int64_t now) const;

  /// [s] until the next step at the latest, nan: none follows.
  [[nodiscard]] double stepLeft(std::int64_t now) const;

  /// Of the step shown, counts from 0 over the whole run; -1: none.
  [[nodiscard]] int number() const { return state_ == State::kPlaying ? number_ : -1; }

 private:
  [[nodiscard]] const LightStep& step() const { return experiment_.light.steps[order_.index()]; }
  /// When the step shown now is over; nothing for the last one of a planned script.
  [[nodiscard]] std::optional<std::int64_t> stepEnd() const;
  [[nodiscard]] std::string whyUnmet() const;
  ScriptTransition show(std::int64_t utime, std::string ended_by, std::string fault);
  ScriptTransition finish(ScriptTransition::Kind kind, std::string ended_by, std::string fault);

  const Experiment& experiment_;
  ScriptCursor order_;
  TumbleCount tumbles_;
  std::optional<StepCondition> condition_;
  enum class State { kWaiting, kStarting, kPlaying, kFinished };
  State state_ = State::kWaiting;
  int number_ = 0;
  std::int64_t start_utime_ = 0;
  std::int64_t end_utime_ = 0;
  std::int64_t step_utime_ = 0;  ///< when the step shown now began; later by the pauses since
  std::optional<std::int64_t> paused_utime_;
};

}  // namespace lab::runner
