#include "runner/script/delivery_watch.hpp"

#include <algorithm>

#include "common/experiment/program_messages.hpp"
#include "common/math/units.hpp"
#include "projector_ctl/projector_core.hpp"

namespace lab::runner {

void DeliveryWatch::take(const light_status_t& status) {
  if (status.command_instance == instance_ && status.command_seq == seq_) {
    if (presented_utime_ == 0) presented_utime_ = status.first_shown_utime;
    // The patch changes periodically, so only its value in the first frame identifies the step.
    if (status.utime == presented_utime_) sync_ = status.sync;
  }
}

void DeliveryWatch::take(const light_seen_t& seen) {
  // Valid until the patch changes by itself.
  const std::int64_t end =
      presented_utime_ + units::microseconds(projector::ProjectorCore::kSyncPeriod);
  const bool shows_it =
      sync_ >= 0 && seen.sync == sync_ && seen.utime >= presented_utime_ && seen.utime < end;
  if (shows_it && seen_utime_ == 0) seen_utime_ = seen.utime;
}

void DeliveryWatch::take(const robot_status_t& status) {
  if (!expected_) return;
  for (const robot_state_t& robot : status.robots) {
    if (robot.origin == robot_state_t::REPLAY) continue;  // it does not react to light
    const auto [entry, is_new] = robots_.try_emplace(robot.robot_id);
    const bool runs_it = robot.program.hash == expected_->hash;
    // Its program before the presentation decides whether the robot has to change.
    const bool before = presented_utime_ == 0 || robot.utime < presented_utime_;
    if (is_new || before) entry->second.must_change = !runs_it;
    if (!before) entry->second.reported_since = true;
    const bool acted = runs_it && presented_utime_ != 0 && !before &&
                       robot.program_start_utime >= presented_utime_;
    if (acted && entry->second.acted_utime == 0) {
      entry->second.must_change = true;
      entry->second.acted_utime = robot.program_start_utime;
    }
  }
}

bool DeliveryWatch::complete() const {
  if (presented_utime_ == 0) return false;
  // If the status of the first frame was lost, the value of the patch is unknown.
  if (must_be_seen_ && sync_ >= 0 && seen_utime_ == 0) return false;
  if (!expected_) return true;
  return robots_.size() >= robots_expected_ &&
         std::all_of(robots_.begin(), robots_.end(), [](const auto& entry) {
           const RobotWatch& robot = entry.second;
           return robot.reported_since && (!robot.must_change || robot.acted_utime != 0);
         });
}

experiment_event_t DeliveryWatch::event() const {
  experiment_event_t event = step_;
  event.presented_utime = presented_utime_;
  event.seen_utime = seen_utime_;
  for (const auto& [id, robot] : robots_) {
    event.robots_expected += robot.must_change ? 1 : 0;
    if (robot.acted_utime == 0) continue;
    ++event.robots_acted;
    event.last_acted_utime = std::max(event.last_acted_utime, robot.acted_utime);
    event.first_acted_utime = event.first_acted_utime == 0
                                  ? robot.acted_utime
                                  : std::min(event.first_acted_utime, robot.acted_utime);
  }
  return event;
}

}  // namespace lab::runner
