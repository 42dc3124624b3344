/// The order and the latest times of the steps of a light script.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/experiment/experiment.hpp"

namespace lab {

/// The shortest step of a script, and the shortest pass of one that repeats [s]. No robot sees a
/// shorter one: a scan of its sensors takes as long.
inline constexpr double kShortestStep = 0.01;

/// The most steps of a run. Each is a command and an event of the log, together about 1 kB.
inline constexpr std::int64_t kMostShownSteps = 1'000'000;

/// Whether a step between these times [s] lasts at least kShortestStep, by whole microseconds.
[[nodiscard]] bool isLongEnough(double begin, double end);

/// A group of steps that is repeated: LightStep::back_to and times.
struct StepGroup {
  std::size_t first = 0;
  std::size_t last = 0;
  std::int64_t times = 1;

  bool operator==(const StepGroup&) const = default;
};

/// The groups of a script that has passed the checks, sorted by their last steps.
[[nodiscard]] std::vector<StepGroup> groupsOf(const LightScript& script);

/// For each step, the latest time [s] at which it can first start. One more element is the latest
/// time at which the script ends, before any repetition of the whole script. Times are rounded to
/// the microsecond.
/// @param holds longest hold time of each step [s]
[[nodiscard]] std::vector<double> latestStartTimes(const std::vector<double>& holds,
                                                   const std::vector<StepGroup>& groups);

/// Whether the script can end the run before its duration is over. Only a script whose times are
/// not known beforehand can (!LightScript::isPlanned()): after its last step, if it does not
/// repeat, or when a condition with if_not = end or safe is not met in time.
[[nodiscard]] bool mayEndEarly(const LightScript& script);

/// Whether the run can end before its duration is over, by its script or by a stop rule.
[[nodiscard]] bool mayEndEarly(const Experiment& experiment);

/// A condition as text without full stop: "D_r of slow is known to 5 %".
[[nodiscard]] std::string conditionText(const EndCondition& until);

/// Iterates over the steps of a script in the order in which they are shown, with the repetitions
/// of groups and of the whole script.
class ScriptCursor {
 public:
  explicit ScriptCursor(const LightScript& script);

  [[nodiscard]] std::size_t index() const { return index_; }  ///< into LightScript::steps
  [[nodiscard]] std::int64_t pass() const { return pass_; }   ///< through the script, from 0

  /// Whether no step follows the present one.
  [[nodiscard]] bool isLast() const;

  /// Not allowed if isLast().
  void advance();

 private:
  [[nodiscard]] const StepGroup* groupEndingHere() const;

  std::size_t steps_;
  bool repeat_;
  std::vector<StepGroup> groups_;
  /// Per group: passes completed; 0 again after the last.
  std::vector<std::int64_t> repetitions_;
  std::size_t index_ = 0;
  std::int64_t pass_ = 0;
};

/// The beginning of a run, as far as it was counted.
struct ShownSteps {
  std::int64_t steps = 0;
  double time = 0;  ///< [s] at which the last of them ends
};

/// Counts the steps that begin within `duration` [s], at most `most`.
/// @param lengths of each step [s], the longest one if a condition may end it; infinity: to the end
[[nodiscard]] ShownSteps countSteps(const LightScript& script, const std::vector<double>& lengths,
                                    double duration, std::int64_t most);

}  // namespace lab
