/// The order and the latest times of the steps of a light script.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/experiment/experiment.hpp"

namespace lab {

/// A group of steps that is repeated: LightStep::back_to and times.
struct StepGroup {
  std::size_t first = 0;
  std::size_t last = 0;
  std::int64_t times = 1;

  bool operator==(const StepGroup&) const = default;
};

/// The groups of a script that has passed the checks, in the order of their last steps.
[[nodiscard]] std::vector<StepGroup> groupsOf(const LightScript& script);

/// The latest time of the first start of each step in the first pass [s]; the last element is the
/// end of the pass. Rounded to the microsecond.
/// @param holds [s] largest hold time of each step
[[nodiscard]] std::vector<double> latestStartTimes(const std::vector<double>& holds,
                                                   const std::vector<StepGroup>& groups);

/// Whether the script may end the run early: after the last step of a script with open times, or
/// because a condition is not met in time.
[[nodiscard]] bool mayEndEarly(const LightScript& script);

/// Whether the run may end early, by its script or by a stop rule.
[[nodiscard]] bool mayEndEarly(const Experiment& experiment);

/// A condition as a sentence without full stop: "D_r of abp is known to 5 %".
[[nodiscard]] std::string untilText(const Until& until);

/// Iterates over the steps of a script in the order in which they are shown, with repetitions.
class ScriptCursor {
 public:
  explicit ScriptCursor(const LightScript& script);

  [[nodiscard]] std::size_t index() const { return index_; }  ///< into LightScript::steps
  [[nodiscard]] std::int64_t pass() const { return pass_; }   ///< of the whole script, from 0

  /// Whether no step follows the present one.
  [[nodiscard]] bool isLast() const;

  /// Advances to the next step. Not allowed if isLast().
  void advance();

 private:
  [[nodiscard]] const StepGroup* groupEndingHere() const;

  std::size_t steps_;
  bool repeat_;
  std::vector<StepGroup> groups_;
  std::vector<std::int64_t> shown_;  ///< by group: completed repetitions
  std::size_t index_ = 0;
  std::int64_t pass_ = 0;
};

}  // namespace lab
