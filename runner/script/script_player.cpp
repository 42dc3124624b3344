#include "runner/script/script_player.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "common/math/units.hpp"

namespace lab::runner {

void ScriptPlayer::begin(std::int64_t utime) {
  state_ = State::kStarting;
  start_utime_ = utime;
  end_utime_ = utime + units::microseconds(experiment_.duration);
}

void ScriptPlayer::pause(std::int64_t now) {
  if (!paused_utime_) paused_utime_ = now;
}

void ScriptPlayer::resume(std::int64_t now) {
  if (!paused_utime_) return;
  const std::int64_t pause = now - *paused_utime_;
  start_utime_ += pause;
  step_utime_ += pause;
  end_utime_ += pause;
  paused_utime_.reset();
}

double ScriptPlayer::elapsed(std::int64_t now) const {
  if (state_ == State::kWaiting) return 0;
  return units::seconds(std::max<std::int64_t>(0, paused_utime_.value_or(now) - start_utime_));
}

double ScriptPlayer::stepLeft(std::int64_t now) const {
  const auto end = state_ == State::kPlaying ? stepEnd() : std::nullopt;
  if (!end || order_.isLast() || *end >= end_utime_) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  return units::seconds(std::max<std::int64_t>(0, *end - paused_utime_.value_or(now)));
}

void ScriptPlayer::take(const tracked_frame_t& frame) {
  if (condition_) condition_->take(frame);
}

void ScriptPlayer::take(const robot_status_t& status) {
  tumbles_.take(status);
  if (condition_) condition_->take(tumbles_);
}

void ScriptPlayer::take(const analysis_t& analysis) {
  if (condition_) condition_->take(analysis);
}

void ScriptPlayer::take(const collective_t& message) {
  if (condition_) condition_->take(message);
}

std::optional<std::int64_t> ScriptPlayer::stepEnd() const {
  const LightScript& script = experiment_.light;
  if (script.isPlanned()) {
    if (order_.isLast()) return std::nullopt;
    ScriptCursor next = order_;
    next.advance();
    const double at =
        static_cast<double>(next.pass()) * script.length + script.steps[next.index()].at;
    return start_utime_ + units::microseconds(at);
  }
  return step_utime_ + units::microseconds(step().hold);
}

std::optional<std::int64_t> ScriptPlayer::due() const {
  if (paused()) return std::nullopt;
  if (state_ == State::kStarting) return start_utime_;
  if (state_ != State::kPlaying) return std::nullopt;
  return std::min(stepEnd().value_or(end_utime_), end_utime_);
}

std::string ScriptPlayer::whyUnmet() const {
  const char* next = step().if_not == IfNot::kNext  ? "the script continues"
                     : step().if_not == IfNot::kEnd ? "the run ends"
                                                    : "the safe light is shown and the run ends";
  return fmt::format("step {} \"{}\": after {} s its condition \"{}\" was not met: {}; {}", number_,
                     step().label, step().hold, conditionText(step().until), condition_->progress(),
                     next);
}

ScriptTransition ScriptPlayer::show(std::int64_t utime, std::string ended_by, std::string fault) {
  step_utime_ = utime;
  condition_.reset();
  if (step().until.given()) condition_.emplace(experiment_, step().until, tumbles_, utime);
  return {ScriptTransition::Kind::kStep, number_, order_.index(), std::move(ended_by),
          std::move(fault)};
}

ScriptTransition ScriptPlayer::finish(ScriptTransition::Kind kind, std::string ended_by,
                                      std::string fault) {
  state_ = State::kFinished;
  condition_.reset();
  return {kind, number_, order_.index(), std::move(ended_by), std::move(fault)};
}

std::optional<ScriptTransition> ScriptPlayer::nextTransition(std::int64_t now) {
  if (paused()) return std::nullopt;
  if (state_ == State::kStarting && now >= start_utime_) {
    state_ = State::kPlaying;
    return show(start_utime_, {}, {});
  }
  if (state_ != State::kPlaying) return std::nullopt;
  std::string ended_by;
  std::string fault;
  std::int64_t next_utime = now;
  const auto end = stepEnd();
  if (condition_ && condition_->met()) {
    ended_by = fmt::format("{}; sample {}", conditionText(step().until), *condition_->met());
  } else if (end && now >= *end && (condition_ || *end < end_utime_)) {
    next_utime = *end;
    if (condition_) {
      ended_by = fmt::format("its limit of {} s; {}", step().hold, condition_->progress());
      fault = whyUnmet();
    }
  } else if (now >= end_utime_) {
    return finish(ScriptTransition::Kind::kOver, {}, {});
  } else {
    return std::nullopt;
  }
  if (!fault.empty() && step().if_not != IfNot::kNext) {
    const bool safe = step().if_not == IfNot::kSafe;
    return finish(safe ? ScriptTransition::Kind::kSafe : ScriptTransition::Kind::kEnd, ended_by,
                  fault);
  }
  if (order_.isLast() || next_utime >= end_utime_) {
    return finish(ScriptTransition::Kind::kOver, ended_by, fault);
  }
  order_.advance();
  ++number_;
  return show(next_utime, ended_by, fault);
}

}  // namespace lab::runner
