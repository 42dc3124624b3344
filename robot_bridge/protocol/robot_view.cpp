#include "robot_bridge/protocol/robot_view.hpp"

#include <algorithm>
#include <utility>

namespace lab::bridge {
namespace {

bool isTumbling(const wire::Telemetry& telemetry) {
  return (telemetry.flags & dynamics::kTumbling) != 0;
}

}  // namespace

/// Whether the robot is in the first phase of a program.
bool RobotView::inRun(const wire::Telemetry& telemetry) const {
  const bool standing =
      state_ && state_->program_epoch == telemetry.program_epoch && state_->program == 0;
  return telemetry.slot < dynamics::kSlots && !standing &&
         (telemetry.flags & (dynamics::kTumbling | dynamics::kReversing)) == 0;
}

void RobotView::reset() {
  RobotView fresh;
  fresh.telemetry_lost_ = telemetry_lost_;
  fresh.steps_lost_ = steps_lost_;
  fresh.frames_bad_before_ = framesBad();
  fresh.steps_ = std::move(steps_);
  *this = std::move(fresh);
}

void RobotView::update(const wire::Telemetry& telemetry, std::uint8_t seq) {
  if (last_) {
    const auto gap = static_cast<std::uint8_t>(seq - telemetry_seq_ - 1);
    if (gap < 128) telemetry_lost_ += gap;  // else a duplicate or a late frame
    countRunTime(telemetry);
    if (isTumbling(telemetry) && !isTumbling(*last_)) ++tumbles_reported_;
  }
  telemetry_seq_ = seq;
  last_ = telemetry;
  if (!fits(telemetry)) return;
  program_epoch_.update(telemetry.program_epoch);
  RobotSnapshot snapshot;
  snapshot.telemetry = telemetry;
  snapshot.state = *state_;
  snapshot.program_epoch = program_epoch_.value();
  snapshot.reversal_count = reversal_count_.value();
  snapshot.tumble_count = tumble_count_.value() + tumbles_reported_;
  snapshot.saturation_count = saturation_count_.value();
  snapshot.run_time_ms = run_time_ms_;
  if (snapshot_) {  // later messages may correct both estimates downwards; report no decrease
    snapshot.tumble_count = std::max(snapshot.tumble_count, snapshot_->tumble_count);
    snapshot.run_time_ms = std::max(snapshot.run_time_ms, snapshot_->run_time_ms);
  }
  snapshot.battery = battery_;
  snapshot_ = snapshot;
  updated_ = true;
}

bool RobotView::fits(const wire::Telemetry& telemetry) const {
  if (!state_ || state_->program_epoch != telemetry.program_epoch) return false;
  if (state_->reversal_count == 0) return (telemetry.flags & dynamics::kReversing) == 0;
  const std::int32_t lasted = msBetween(state_->reversal_start_ms, state_->reversal_end_ms);
  if (lasted == 0) return true;
  return (lasted < 0) == ((telemetry.flags & dynamics::kReversing) != 0);
}

// COUNTERS gives the time in runs once a second. In between, each interval between two telemetries
// counts half for each end that is in a run.
void RobotView::countRunTime(const wire::Telemetry& telemetry) {
  const double passed = std::max(0, msBetween(last_->t_ms, telemetry.t_ms));
  run_time_ms_ += passed * ((inRun(*last_) ? 0.5 : 0) + (inRun(telemetry) ? 0.5 : 0));
}

void RobotView::update(const wire::State& state) {
  state_ = state;
  program_epoch_.update(state.program_epoch);
  reversal_count_.update(state.reversal_count);
  tumble_count_.update(state.tumble_count);
  tumbles_reported_ = 0;
}

void RobotView::update(const wire::Counters& counters) {
  saturation_count_.update(counters.saturation_count);
  frames_bad_.update(counters.frames_bad);
  battery_ = counters.battery_mv / 1000.0;
  // The next telemetry adds the whole time since the last one, so subtract the part of it that is
  // already in this message.
  run_time_ms_ = counters.run_time_ms;
  if (last_ && inRun(*last_)) {
    run_time_ms_ -= std::clamp(msBetween(last_->t_ms, counters.t_ms), 0, 1000);
    run_time_ms_ = std::max(0.0, run_time_ms_);
  }
}

void RobotView::update(const wire::Step& step) {
  if (draw_count_) {
    const std::uint32_t gap = step.draw_count - *draw_count_ - 1;
    if (gap < (1U << 31U)) steps_lost_ += gap;
  }
  draw_count_ = step.draw_count;
  const std::uint32_t epoch = program_epoch_.value();  // a step may come before or after its STATE
  const auto ahead = static_cast<std::int16_t>(step.program_epoch - epoch);
  steps_.push_back({step, epoch + static_cast<std::uint32_t>(ahead)});
}

bool RobotView::takeUpdateFlag() { return std::exchange(updated_, false); }

std::vector<RobotView::UnwrappedStep> RobotView::takeSteps() { return std::exchange(steps_, {}); }

}  // namespace lab::bridge
