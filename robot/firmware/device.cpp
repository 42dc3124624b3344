#include "robot/firmware/device.hpp"

namespace lab {
namespace firmware {
namespace {

constexpr uint8_t kFirstAnswerType = 0x80;

}  // namespace

Device::Device(Board& board, const BootFacts& facts)
    : board_(board), facts_(facts), programs_(board), core_(programs_), store_(board) {}

void Device::boot(uint32_t now_ms) {
  now_ms_ = now_ms;
  board_.setMotors(0, 0);
  store_.load(settings_);
  programs_.load();
  startBootCounter();
  seed(settings_.uid, boot_id_);
  scan_due_ms_ = now_ms;
  note(now_ms, wire::kBooted, facts_.reset_cause);
  if (store_.bank() == kNoBank) {
    note(now_ms, wire::kSettingsDefault, 0);
  }
  sendHello(now_ms, 0);
  hello_due_ms_ = now_ms + kHelloPeriodMs;
}

// Sets a boot id that differs after every reset. Multiplication by an odd number keeps different
// counts different, and gives different ids to robots with equal counts.
void Device::startBootCounter() {
  const uint16_t low = board_.readStore(kBootCounterAddress);
  const uint16_t high = board_.readStore(kBootCounterAddress + 1);
  const uint16_t boots = static_cast<uint16_t>(static_cast<uint16_t>(high << 8 | low) + 1U);
  board_.writeStore(kBootCounterAddress, static_cast<uint8_t>(boots & 0xFFU));
  if (boots >> 8 != high) {
    board_.writeStore(kBootCounterAddress + 1, static_cast<uint8_t>(boots >> 8));
  }
  const uint16_t robot = static_cast<uint16_t>(settings_.uid ^ (settings_.uid >> 16));
  boot_id_ = static_cast<uint16_t>(static_cast<uint16_t>(boots * 40503UL) ^ robot);
}

void Device::receive(uint32_t now_ms, uint16_t now_us, uint8_t byte) {
  if (!decoder_.push(byte)) {
    return;
  }
  // Messages of robots are echoes of our own or come from another robot. Answering them could start
  // an endless exchange.
  if (decoder_.frame().type >= kFirstAnswerType) {
    return;
  }
  if (!reached(now_ms, now_ms_)) {
    // The byte was read late, and the core has already advanced beyond its reception.
    handleCommand(decoder_.frame(), now_ms_, now_ms, now_us);
  } else {
    advance(now_ms);
    handleCommand(decoder_.frame(), now_ms, now_ms, now_us);
  }
  finishUpdate(now_ms_);
}

void Device::noteOverrun(uint16_t bytes) {
  bytes_overrun_ = static_cast<uint16_t>(bytes_overrun_ + bytes);
}

void Device::noteWatchdog(uint32_t now_ms) { note(now_ms, wire::kWatchdogRestart, 0); }

bool Device::scanDue(uint32_t now_ms) const { return reached(now_ms, scan_due_ms_); }

void Device::sense(uint32_t now_ms, const dynamics::Sensors& sensors) {
  advance(now_ms);
  core_.sense(now_ms, sensors);
  finishUpdate(now_ms);
  // Keeps the phase however long the scan took, unless it took more than a period.
  scan_due_ms_ += core_.settings().sensor_period_ms;
  if (reached(now_ms, scan_due_ms_)) {
    scan_due_ms_ = now_ms + 1;
  }
}

void Device::tick(uint32_t now_ms) {
  advance(now_ms);
  continueStoring(now_ms);
  report(now_ms);
}

// Advances the core to now, one event after the other, so that every draw is recorded.
void Device::advance(uint32_t now_ms) {
  now_ms_ = now_ms;
  while (core_.advanceOne(now_ms)) {
    finishUpdate(now_ms);
  }
}

// To be called after everything that may have changed the core.
void Device::finishUpdate(uint32_t now_ms) {
  recordDraw();
  driveMotors();
  const dynamics::CoreReport& report = core_.record();
  const bool leased = (core_.flags() & dynamics::kLeaseExpired) == 0;
  if (leased_ && !leased) {
    note(now_ms, wire::kLeaseOver, 0);
  }
  leased_ = leased;
  const uint16_t epoch = static_cast<uint16_t>(report.program_epoch);
  const uint16_t reversals = static_cast<uint16_t>(report.reversal_count);
  if (epoch != known_epoch_ || reversals != known_reversals_ ||
      report.reversal_end_ms != known_reversal_end_ms_) {
    known_epoch_ = epoch;
    known_reversals_ = reversals;
    known_reversal_end_ms_ = report.reversal_end_ms;
    state_changed_ = true;
  }
}

void Device::recordDraw() {
  const dynamics::CoreReport& report = core_.record();
  if (report.draw_count == draws_recorded_) {
    return;
  }
  draws_recorded_ = report.draw_count;
  if (!step_log_ || !host_heard_) {
    return;
  }
  wire::Step step;
  step.t_ms = core_.holdStartMs();
  step.draw_count = report.draw_count;
  step.program_epoch = static_cast<uint16_t>(report.program_epoch);
  step.slot = report.slot;
  step.phase = report.phase;
  step.left_um_s = report.held.left;
  step.right_um_s = report.held.right;
  step.duration_ms = core_.holdDurationMs();
  step.rng = core_.rng().digest();
  if (!steps_.push(step)) {
    ++frames_dropped_;
  }
}

void Device::driveMotors() {
  const dynamics::WheelSpeedsUmS wheels = core_.wheels();
  if (!recalibrated_ && wheels.left == driven_wheels_.left &&
      wheels.right == driven_wheels_.right) {
    return;
  }
  if (recalibrated_) {
    recalibrated_ = false;
    full_left_ = dynamics::fullSpeed(core_.settings().max_wheel_um_s, settings_.left);
    full_right_ = dynamics::fullSpeed(core_.settings().max_wheel_um_s, settings_.right);
  }
  driven_wheels_ = wheels;
  const int16_t left = dynamics::dutyOfWheel(wheels.left, full_left_, settings_.left);
  const int16_t right = dynamics::dutyOfWheel(wheels.right, full_right_, settings_.right);
  if (left != duty_left_ || right != duty_right_) {
    duty_left_ = left;
    duty_right_ = right;
    board_.setMotors(left, right);
  }
}

void Device::note(uint32_t now_ms, wire::EventCode code, uint32_t data) {
  wire::Event event;
  event.t_ms = now_ms;
  event.number = ++event_number_;
  event.code = code;
  event.data = data;
  if (!events_.push(event)) {
    ++frames_dropped_;
  }
}

}  // namespace firmware
}  // namespace lab
