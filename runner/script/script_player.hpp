/// Decides which step of the light script is shown when. Pure: no bus, no clock.
#pragma once

#include <cstddef>
#include <cstdint>
#include <lab/analysis_t.hpp>
#include <lab/collective_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <optional>
#include <string>

#include "common/experiment/experiment.hpp"
#include "common/experiment/script_plan.hpp"
#include "runner/script/step_condition.hpp"
#include "runner/script/tumble_count.hpp"

namespace lab::runner {

/// A change in the script: the next step, or its end.
struct ScriptTransition {
  enum class Kind {
    kStep,  ///< a step begins
    kOver,  ///< the script has ended normally
    kEnd,   ///< the run ends: a condition was not met
    kSafe,  ///< as kEnd, with safe light and stopped robots
  };
  Kind kind = Kind::kStep;
  int number = 0;         ///< number of the step in the run, from 0
  std::size_t index = 0;  ///< into LightScript::steps
  std::string ended_by;   ///< what ended the previous step; empty if its time was over
  std::string fault;      ///< condition that was not met in time; empty if none

  bool operator==(const ScriptTransition&) const = default;
};

/// Plays a script once. Gets the time and the messages of the lab and returns the transitions.
/// Times are microseconds since 1970.
class ScriptPlayer {
 public:
  /// @param experiment must outlive the player
  explicit ScriptPlayer(const Experiment& experiment)
      : experiment_(experiment), order_(experiment.light) {}

  void begin(std::int64_t utime);

  /// Stops the clock of the script: no step ends, and the remaining times of step and run do not
  /// change. If the condition of the step is met during the pause, the next step begins at
  /// resume().
  void pause(std::int64_t now);

  /// Shifts all remaining times by the length of the pause.
  void resume(std::int64_t now);

  [[nodiscard]] bool paused() const { return paused_utime_.has_value(); }

  void take(const tracked_frame_t& frame);
  void take(const robot_status_t& status);
  void take(const analysis_t& analysis);
  void take(const collective_t& message);

  /// @return the next transition that is due; nothing if the step goes on. Call again until nothing
  ///   is due. After a condition was met, the next step begins `now`; otherwise it begins when the
  ///   time of the step was over, so that late calls do not accumulate.
  [[nodiscard]] std::optional<ScriptTransition> nextTransition(std::int64_t now);

  /// Latest time of the next transition. Nothing before begin(), during a pause, and after the last
  /// transition.
  [[nodiscard]] std::optional<std::int64_t> due() const;

  /// Latest end of the run, if no further pause follows.
  [[nodiscard]] std::int64_t endUtime() const { return end_utime_; }

  /// Time since begin() without pauses [s].
  [[nodiscard]] double elapsed(std::int64_t now) const;

  /// Longest time until the next step [s]; NaN if none follows.
  [[nodiscard]] double stepLeft(std::int64_t now) const;

  /// Number of the current step in the run, from 0; -1 if none.
  [[nodiscard]] int number() const { return state_ == State::kPlaying ? number_ : -1; }

 private:
  [[nodiscard]] const LightStep& step() const { return experiment_.light.steps[order_.index()]; }
  /// End of the current step; nothing for the last step of a planned script.
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
  std::int64_t step_utime_ = 0;  ///< begin of the current step, shifted by later pauses
  std::optional<std::int64_t> paused_utime_;
};

}  // namespace lab::runner
