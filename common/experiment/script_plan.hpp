/// In which order, and by when, the steps of a light script are shown.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/experiment/experiment.hpp"

namespace lab {

/// Steps that are shown several times: LightStep::back_to and times.
struct StepGroup {
  std::size_t first = 0;
  std::size_t last = 0;
  std::int64_t times = 1;

  bool operator==(const StepGroup&) const = default;
};

/// The groups of a script that has passed the checks, in the order of their last steps.
[[nodiscard]] std::vector<StepGroup> groupsOf(const LightScript& script);

/// When each step of the first pass begins at the latest, for the first time [s]; the last element
/// is when the pass ends. Rounded to the microsecond.
/// @param holds [s] of every step, at most
[[nodiscard]] std::vector<double> latestStartTimes(const std::vector<double>& holds,
                                                   const std::vector<StepGroup>& groups);

/// Whether the run may end before its time: with the last step of a script whose times are open, or
/// where a condition is not met.
[[nodiscard]] bool mayEndEarly(const LightScript& script);

/// Whether the run may end before its time, by its script or by a rule.
[[nodiscard]] bool mayEndEarly(const Experiment& experiment);

/// What a step waits for, as a sentence without its full stop: "D_r of abp is known to 5 %".
[[nodiscard]] std::string untilText(const Until& until);

/// Walks through the showings of a script.
class ScriptCursor {
 public:
  explicit ScriptCursor(const LightScript& script);

  [[nodiscard]] std::size_t index() const { return index_; }  ///< into LightScript::steps
  [[nodiscard]] std::int64_t pass() const { return pass_; }   ///< of the whole script, from 0

  /// Whether nothing follows the showing here.
  [[nodiscard]] bool isLast() const;

  /// Goes on to the next showing. Not after the last one.
  void advance();

 private:
  [[nodiscard]] const StepGroup* groupEndingHere() const;

  std::size_t steps_;
  bool repeat_;
  std::vector<StepGroup> groups_;
  std::vector<std::int64_t> shown_;  ///< by group: how often it has been shown to its end
  std::size_t index_ = 0;
  std::int64_t pass_ = 0;
};

}  // namespace lab
