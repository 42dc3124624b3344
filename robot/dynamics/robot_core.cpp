#include "robot/dynamics/robot_core.hpp"

namespace lab {
namespace dynamics {
namespace {

constexpr uint8_t kFrontSensors = (1U << 0) | (1U << 1) | (1U << 5);  // 0, +60, -60 degrees
constexpr uint8_t kRearSensors = (1U << 2) | (1U << 3) | (1U << 4);   // +120, 180, -120 degrees

// True if `a` is at or before `b` on a clock that wraps around.
bool notAfter(uint32_t a, uint32_t b) { return static_cast<int32_t>(b - a) >= 0; }

/// The speed of a reversal that has begun is positive.
uint32_t reversalMs(const ReversalSettings& reversal) {
  const uint32_t speed = static_cast<uint32_t>(reversal.speed_um_s);
  return (reversal.distance_um * 1000U + speed / 2U) / speed;
}

bool equal(const ReversalSettings& a, const ReversalSettings& b) {
  return a.enabled == b.enabled && a.distance_um == b.distance_um && a.speed_um_s == b.speed_um_s &&
         a.ir_margin == b.ir_margin;
}

void addIf(bool condition, CoreFlag flag, uint16_t& flags) {
  if (condition) {
    flags = static_cast<uint16_t>(flags | flag);
  }
}

}  // namespace

constexpr uint32_t RobotCore::kNoEventMs;

bool operator==(const CoreSettings& a, const CoreSettings& b) {
  for (uint8_t i = 0; i < kSlots; ++i) {
    if (a.programs[i] != b.programs[i]) {
      return false;
    }
  }
  return a.light == b.light && equal(a.reversal, b.reversal) &&
         a.max_wheel_um_s == b.max_wheel_um_s && a.half_wheel_base_um == b.half_wheel_base_um &&
         a.sensor_period_ms == b.sensor_period_ms && a.robot_id == b.robot_id;
}

void RobotCore::configure(uint32_t now_ms, const CoreSettings& settings) {
  advanceTo(now_ms);
  if (configured_ && settings == settings_ &&
      !(missing_ && programs_->find(settings_.programs[report_.slot]).size != 0)) {
    return;
  }
  configured_ = true;
  settings_ = settings;
  inputs_.id = settings.robot_id;
  inputs_.half_wheel_base_um = settings.half_wheel_base_um;
  odometry_.setHalfWheelBase(settings.half_wheel_base_um);
  light_.configure(settings.light);
  if (measured_) {
    light_.update(inputs_.sensors.light_front, inputs_.sensors.light_back);
  }
  restart(now_ms);
}

void RobotCore::runPrograms(uint32_t now_ms) { setMode(now_ms, kTable); }

void RobotCore::stand(uint32_t now_ms) { setMode(now_ms, kStand); }

void RobotCore::driveWheels(uint32_t now_ms, int32_t left_um_s, int32_t right_um_s) {
  if (left_um_s != driven_wheels_.left || right_um_s != driven_wheels_.right) {
    advanceTo(now_ms);
    driven_wheels_.left = left_um_s;
    driven_wheels_.right = right_um_s;
    if (mode_ == kCommanded) {
      restart(now_ms);
    }
  }
  setMode(now_ms, kCommanded);
}

void RobotCore::setMode(uint32_t now_ms, Mode mode) {
  advanceTo(now_ms);
  if (mode != mode_) {
    mode_ = mode;
    restart(now_ms);
  }
}

void RobotCore::stop(uint32_t now_ms) {
  advanceTo(now_ms);
  if (!stopped_) {
    stopped_ = true;
    restart(now_ms);
  }
}

void RobotCore::clearStop(uint32_t now_ms) {
  advanceTo(now_ms);
  if (stopped_) {
    stopped_ = false;
    restart(now_ms);
  }
}

void RobotCore::renewLease(uint32_t now_ms, uint32_t lease_ms) {
  advanceTo(now_ms);
  const bool was_leased = leased_;
  leased_ = lease_ms > 0;
  lease_end_ms_ = now_ms + (lease_ms < kNoEventMs ? lease_ms : kNoEventMs);
  if (leased_ != was_leased) {
    restart(now_ms);
  }
}

void RobotCore::sense(uint32_t now_ms, const Sensors& sensors) {
  advanceTo(now_ms);
  inputs_.sensors = sensors;
  measured_ = true;
  const uint8_t approaching = approachingSensors();
  const uint8_t old_slot = light_.slot();
  const uint8_t slot = light_.update(sensors.light_front, sensors.light_back);
  const bool switched = slot != old_slot && mode_ == kTable && mayMove();
  if (switched) {
    switchProgram(now_ms);
  }
  if (reversal_direction_ != 0) {
    const uint8_t ahead = reversal_direction_ > 0 ? kFrontSensors : kRearSensors;
    if ((approaching & ahead) != 0) {
      endReversal(now_ms);
    }
    return;
  }
  // At no speed a reversal would never end.
  if (approaching != 0 && report_.slot != kNoSlot && settings_.reversal.enabled &&
      settings_.reversal.speed_um_s > 0) {
    const int32_t forward = wrappingSum(report_.held.left, report_.held.right);
    if (forward > 0 && (approaching & kFrontSensors) != 0) {
      beginReversal(now_ms, -1);
      return;
    }
    if (forward < 0 && (approaching & kRearSensors) != 0) {
      beginReversal(now_ms, 1);
      return;
    }
  }
  // A program that has just begun waits for the next scan, so that a scan makes at most one draw.
  if (machine_.canBeInterrupted() && !switched) {
    lookForInterruption(now_ms);
  }
}

void RobotCore::advanceTo(uint32_t now_ms) {
  while (advanceOne(now_ms)) {
  }
}

bool RobotCore::advanceOne(uint32_t now_ms) {
  uint32_t at_ms = 0;
  const Event event = nextEvent(now_ms, at_ms);
  if (event == kNothing || !notAfter(at_ms, now_ms)) {
    return false;
  }
  switch (event) {
    case kLeaseEnd:
      leased_ = false;
      restart(at_ms);
      break;
    case kReversalEnd:
      endReversal(at_ms);
      break;
    case kHoldEnd:
      beginHold(at_ms);
      break;
    case kNothing:
      break;
  }
  return true;
}

uint32_t RobotCore::nextEventMs(uint32_t now_ms) const {
  uint32_t at_ms = 0;
  return nextEvent(now_ms, at_ms) == kNothing ? now_ms + kNoEventMs : at_ms;
}

WheelSpeedsUmS RobotCore::wheels() const {
  if (reversal_direction_ == 0) {
    return report_.held;
  }
  WheelSpeedsUmS back;
  back.left = reversal_direction_ * settings_.reversal.speed_um_s;
  back.right = back.left;
  return back;
}

CoreReport RobotCore::report() const {
  CoreReport report = report_;
  report.flags = flags();
  return report;
}

uint16_t RobotCore::flags() const {
  uint16_t flags = 0;
  addIf(reversal_direction_ != 0, kReversing, flags);
  addIf(stopped_, kStopped, flags);
  addIf(!leased_, kLeaseExpired, flags);
  addIf(saturated_, kSaturated, flags);
  addIf(report_.phase != 0, kTumbling, flags);
  addIf(mode_ == kCommanded, kDriven, flags);
  addIf(light_.slot() == kNoSlot, kNoLightBand, flags);
  addIf(!configured_, kUnconfigured, flags);
  addIf(missing_, kNoProgram, flags);
  return flags;
}

uint32_t RobotCore::runTimeMs(uint32_t now_ms) const {
  return run_time_ms_ + (inRun() ? now_ms - counted_ms_ : 0);
}

// Updates times and odometry; to be called before any change of the state that they depend on.
void RobotCore::countTime(uint32_t now_ms) {
  const uint32_t passed_ms = now_ms - counted_ms_;
  counted_ms_ = now_ms;
  if (report_.program == 0 || reversal_direction_ != 0) {
    return;
  }
  run_time_ms_ += report_.phase == 0 ? passed_ms : 0;
  program_time_ms_ += passed_ms;
  odometry_.add(report_.held.left, report_.held.right, passed_ms);
}

// The earliest pending event. At equal times the end of the lease comes first, because stopping
// takes precedence over a draw.
RobotCore::Event RobotCore::nextEvent(uint32_t now_ms, uint32_t& at_ms) const {
  Event event = kNothing;
  at_ms = now_ms + kNoEventMs;
  if (leased_) {
    event = kLeaseEnd;
    at_ms = lease_end_ms_;
  }
  if (reversal_direction_ != 0) {
    if (event == kNothing || !notAfter(at_ms, reversal_due_ms_)) {
      event = kReversalEnd;
      at_ms = reversal_due_ms_;
    }
  } else if (hold_ends_ && (event == kNothing || !notAfter(at_ms, hold_end_ms_))) {
    event = kHoldEnd;
    at_ms = hold_end_ms_;
  }
  return event;
}

// Ends the running program and any reversal, and starts what the present mode requires.
void RobotCore::restart(uint32_t now_ms) {
  if (reversal_direction_ != 0) {
    endReversal(now_ms);
  }
  startSelected(now_ms);
}

// Starts the program that the light selects. During a reversal it is drawn and then paused until
// the end of the reversal.
void RobotCore::switchProgram(uint32_t now_ms) {
  if (reversal_direction_ != 0 && light_.slot() == kNoSlot) {
    endReversal(now_ms);  // there is no program to resume
  }
  startSelected(now_ms);
  hold_remaining_ms_ = hold_end_ms_ - now_ms;
}

void RobotCore::startSelected(uint32_t now_ms) {
  countTime(now_ms);
  report_.slot = kNoSlot;
  uint32_t hash = 0;
  if (mayMove() && mode_ == kTable && light_.slot() < kSlots) {
    report_.slot = light_.slot();
    hash = settings_.programs[report_.slot];
  }
  const ProgramBytes program = hash == 0 ? ProgramBytes() : programs_->find(hash);
  missing_ = hash != 0 && program.size == 0;
  report_.program = missing_ ? 0 : hash;
  ++report_.program_epoch;
  report_.program_start_ms = now_ms;
  odometry_.reset();
  program_time_ms_ = 0;
  phase_begin_ms_ = 0;
  if (report_.program != 0) {
    updateInputs();
  }
  machine_.start(program.code, program.size, inputs_, rng_);
  beginHold(now_ms);
}

void RobotCore::updateInputs() {
  inputs_.time_ms = program_time_ms_;
  inputs_.phase_time_ms = program_time_ms_ - phase_begin_ms_;
  inputs_.heading_turns = odometry_.headingTurns();
  inputs_.distance_um = odometry_.distanceUm();
}

void RobotCore::beginHold(uint32_t now_ms) {
  countTime(now_ms);
  phase_begin_ms_ = program_time_ms_;
  PhaseResult hold;
  hold.duration_ms = kEndless;
  if (report_.program != 0) {
    updateInputs();
    hold = machine_.next(inputs_, rng_);
  } else if (mayMove() && mode_ == kCommanded) {
    hold.left_um_s = driven_wheels_.left;
    hold.right_um_s = driven_wheels_.right;
  }
  saturated_ = machine_.takeSaturated();
  report_.held.left = clampWheel(hold.left_um_s, settings_.max_wheel_um_s, saturated_);
  report_.held.right = clampWheel(hold.right_um_s, settings_.max_wheel_um_s, saturated_);
  report_.phase = machine_.phase();
  hold_ends_ = hold.duration_ms != kEndless;
  hold_start_ms_ = now_ms;
  hold_duration_ms_ = hold.duration_ms;
  hold_end_ms_ = now_ms + hold.duration_ms;
  ++report_.draw_count;
  report_.tumble_count += report_.phase != 0 ? 1U : 0U;
  report_.saturation_count += saturated_ ? 1U : 0U;
}

// Ends the hold if the sensors fulfil the condition of the phase.
void RobotCore::lookForInterruption(uint32_t now_ms) {
  countTime(now_ms);
  updateInputs();
  if (machine_.interrupted(inputs_, rng_)) {
    beginHold(now_ms);
  } else if (machine_.takeSaturated() && !saturated_) {
    saturated_ = true;
    ++report_.saturation_count;
  }
}

void RobotCore::beginReversal(uint32_t now_ms, int8_t direction) {
  countTime(now_ms);
  hold_remaining_ms_ = hold_end_ms_ - now_ms;
  reversal_direction_ = direction;
  reversal_due_ms_ = now_ms + reversalMs(settings_.reversal);
  ++report_.reversal_count;
  report_.reversal_start_ms = now_ms;
  resetBaselines();
}

void RobotCore::endReversal(uint32_t now_ms) {
  countTime(now_ms);
  reversal_direction_ = 0;
  hold_end_ms_ = now_ms + hold_remaining_ms_;
  report_.reversal_end_ms = now_ms;
  resetBaselines();
}

void RobotCore::resetBaselines() {
  for (uint8_t i = 0; i < kIrSensors; ++i) {
    baseline_[i] = inputs_.sensors.ir[i];
  }
}

// Lowers the baselines to lower readings. Returns a bit mask of the sensors that detect an
// approach.
uint8_t RobotCore::approachingSensors() {
  const uint32_t margin = settings_.reversal.ir_margin;
  uint8_t mask = 0;
  for (uint8_t i = 0; i < kIrSensors; ++i) {
    const uint16_t reading = inputs_.sensors.ir[i];
    if (reading < baseline_[i]) {
      baseline_[i] = reading;
    }
    if (reading > baseline_[i] + margin) {
      mask = static_cast<uint8_t>(mask | (1U << i));
    }
  }
  return mask;
}

}  // namespace dynamics
}  // namespace lab
