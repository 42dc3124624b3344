#include "runner/commands/log_playback.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <lab/experiment_event_t.hpp>
#include <limits>
#include <set>
#include <tuple>

#include "common/bus/channels.hpp"
#include "common/bus/codec.hpp"
#include "common/math/units.hpp"

namespace lab::runner {
namespace {

constexpr std::int64_t kReplayedBefore_us = 2'000'000;
constexpr double kSlowest = 1e-3;
constexpr double kFastest = 1e4;

/// Equal for the copies of one event: events are sent three times, START and CALIBRATION again
/// every minute.
using EventKey = std::tuple<std::int8_t, std::int64_t, std::int32_t, std::string>;

EventKey keyOf(const experiment_event_t& event) {
  const bool repeats =
      event.kind == experiment_event_t::START || event.kind == experiment_event_t::CALIBRATION;
  return {event.kind, repeats ? 0 : event.utime, event.step, repeats ? event.label : event.text};
}

std::vector<std::size_t> distinctEvents(LogEvents& log) {
  std::vector<std::size_t> indices;
  std::set<EventKey> known;
  for (std::size_t i = 0; i < log.all().size(); ++i) {
    const LogEvent& logged = log.all()[i];
    if (log.channelOf(logged) != channels::kExperimentEvent) continue;
    experiment_event_t event{};
    if (decode(log.messageOf(logged), event) && known.insert(keyOf(event)).second) {
      indices.push_back(i);
    }
  }
  return indices;
}

}  // namespace

LogPlayback::LogPlayback(LogEvents& log, std::string run, double speed, AtEnd at_end,
                         std::int64_t now)
    : log_(log),
      events_(log.all()),
      run_(std::move(run)),
      speed_(speed),
      at_end_(at_end),
      clock_(events_.front().utime, now, speed),
      event_indices_(distinctEvents(log)) {}

std::int64_t LogPlayback::logTime(std::int64_t now) const {
  return std::min(clock_.logTime(now), events_.back().utime);
}

std::int64_t LogPlayback::recordedTime(std::int64_t now) const {
  const std::int64_t time = logTime(now);
  const auto after = std::ranges::upper_bound(events_, time, {}, &LogEvent::utime);
  const LogEvent& before = after == events_.begin() ? *after : *(after - 1);
  return before.log_utime + (time - before.utime);
}

double LogPlayback::elapsed(std::int64_t now) const {
  return units::seconds(logTime(now) - events_.front().utime);
}

double LogPlayback::length() const {
  return units::seconds(events_.back().utime - events_.front().utime);
}

std::size_t LogPlayback::firstAt(std::int64_t log_utime) const {
  const auto first = std::ranges::lower_bound(events_, log_utime, {}, &LogEvent::utime);
  return static_cast<std::size_t>(first - events_.begin());
}

void LogPlayback::jumpTo(std::int64_t log_utime, std::int64_t now) {
  const bool was_paused = paused();
  clock_ = ReplayClock(log_utime, now, speed_);
  if (was_paused) clock_.pause(now);
  next_ = firstAt(log_utime);
  jumped_ = true;
  ++jumps_;
}

std::string LogPlayback::execute(const experiment_command_t& command, std::int64_t now) {
  switch (command.action) {
    case experiment_command_t::PAUSE:
      if (paused()) return "the replay is paused already";
      clock_.pause(now);
      return {};
    case experiment_command_t::RESUME:
      return resume(now);
    case experiment_command_t::SEEK:
      return seek(command.value, now);
    case experiment_command_t::SPEED:
      return setSpeed(command.value, now);
    case experiment_command_t::END:
      over_ = true;
      return {};
    default:
      return "this is a replay: it has no robots and takes no remarks";
  }
}

std::string LogPlayback::resume(std::int64_t now) {
  if (!paused()) return "the replay is not paused";
  if (next_ == events_.size()) jumpTo(events_.front().utime, now);
  clock_.resume(now);
  return {};
}

std::string LogPlayback::seek(double to, std::int64_t now) {
  // Written so that nan is refused too.
  if (!(to >= 0 && to <= length())) {
    return fmt::format("the log has no {} s, allowed 0 to {:.3f}", to, length());
  }
  jumpTo(events_.front().utime + units::microseconds(to), now);
  return {};
}

std::string LogPlayback::setSpeed(double speed, std::int64_t now) {
  if (!(speed >= kSlowest && speed <= kFastest)) {
    return fmt::format("found a speed of {}, allowed {:g} to {:g}", speed, kSlowest, kFastest);
  }
  const bool was_paused = paused();
  clock_ = ReplayClock(logTime(now), now, speed);
  if (was_paused) clock_.pause(now);
  speed_ = speed;
  return {};
}

void LogPlayback::pauseOrResume(std::int64_t now) {
  experiment_command_t command{};
  command.action = paused() ? experiment_command_t::RESUME : experiment_command_t::PAUSE;
  static_cast<void>(execute(command, now));
}

bool LogPlayback::advance(std::int64_t now) {
  if (next_ < events_.size() || jumped_ || !catch_up_.empty() || paused()) return false;
  switch (at_end_) {
    case AtEnd::kEnd:
      over_ = true;
      break;
    case AtEnd::kPause:
      clock_ = ReplayClock(events_.back().utime, now, speed_);
      clock_.pause(now);
      break;
    case AtEnd::kLoop:
      jumpTo(events_.front().utime, now);
      break;
  }
  return true;
}

void LogPlayback::sendEvent(std::size_t index, const Send& send) {
  const LogEvent& event = events_[index];
  send(log_.channelOf(event), log_.messageOf(event));
}

void LogPlayback::play(std::int64_t now, const Send& send) {
  if (jumped_) {
    jumped_ = false;
    catch_up_.clear();
    const std::size_t near = firstAt(logTime(now) - kReplayedBefore_us);
    for (const std::size_t index : event_indices_) {
      if (index < std::min(near, next_)) catch_up_.push_back(index);
    }
    for (std::size_t index = near; index < next_; ++index) catch_up_.push_back(index);
  }
  std::size_t left = kMostAtOnce;
  for (; left > 0 && !catch_up_.empty(); --left) {
    sendEvent(catch_up_.front(), send);
    catch_up_.pop_front();
  }
  const std::int64_t until = clock_.logTime(now);
  for (; left > 0 && next_ < events_.size() && events_[next_].utime <= until; --left) {
    sendEvent(next_++, send);
  }
}

experiment_status_t LogPlayback::status(std::int64_t now) const {
  experiment_status_t status{};
  status.run = run_;
  status.phase = paused() ? experiment_status_t::PLAY_PAUSED : experiment_status_t::PLAYING;
  status.elapsed = elapsed(now);
  status.left = length() - status.elapsed;
  status.rate = speed_;
  status.jumps = jumps_;
  status.step = -1;
  status.step_left = std::numeric_limits<double>::quiet_NaN();
  return status;
}

}  // namespace lab::runner
