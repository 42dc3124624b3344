#include "robot/firmware/device.hpp"

namespace lab {
namespace firmware {
namespace {

enum Turn : uint8_t { kStepTurn, kTelemetryTurn, kCountersTurn, kTurns };

}  // namespace

template <class Message>
void Device::send(const Message& message, uint8_t seq) {
  wire::Frame frame;
  wire::pack(message, seq, frame);
  transmit(frame);
}

void Device::transmit(const wire::Frame& frame) {
  uint8_t bytes[wire::kMaxFrame];
  if (!board_.send(bytes, wire::encode(frame, bytes))) {
    ++frames_dropped_;
  }
}

void Device::startReports(uint32_t now_ms) {
  telemetry_due_ms_ = now_ms;
  state_due_ms_ = now_ms;
  counters_due_ms_ = now_ms;
}

// Sends at most one frame per call, the most urgent one. Draws, telemetry and counters take turns,
// so that each gets its share of a line that cannot carry all.
void Device::report(uint32_t now_ms) {
  if (!board_.lineIdle()) {
    return;
  }
  if (!host_heard_) {
    if (reached(now_ms, hello_due_ms_)) {
      sendHello(now_ms, 0);
      hello_due_ms_ = now_ms + kHelloPeriodMs;
    }
    return;
  }
  if (!events_.empty()) {
    sendEvent(events_.front());
    events_.pop();
    return;
  }
  if (stateDue(now_ms)) {
    sendState(now_ms);
    return;
  }
  for (uint8_t i = 0; i < kTurns; ++i) {
    turn_ = turn_ + 1U < kTurns ? static_cast<uint8_t>(turn_ + 1U) : 0;
    if (sendInTurn(turn_, now_ms)) {
      return;
    }
  }
}

bool Device::sendInTurn(uint8_t turn, uint32_t now_ms) {
  if (turn == kStepTurn && !steps_.empty()) {
    sendStep(steps_.front());
    steps_.pop();
    return true;
  }
  if (turn == kTelemetryTurn && telemetryDue(now_ms)) {
    sendTelemetry(now_ms);
    return true;
  }
  if (turn == kCountersTurn && reached(now_ms, counters_due_ms_)) {
    sendCounters(now_ms);
    return true;
  }
  return false;
}

bool Device::telemetryDue(uint32_t now_ms) const {
  return telemetry_period_ms_ > 0 && reached(now_ms, telemetry_due_ms_);
}

bool Device::stateDue(uint32_t now_ms) const {
  return state_changed_ || reached(now_ms, state_due_ms_);
}

void Device::sendHello(uint32_t now_ms, uint8_t seq) {
  wire::Hello hello;
  hello.schema = wire::kSchema;
  hello.firmware = kFirmwareVersion;
  hello.build = facts_.build;
  hello.uid = settings_.uid;
  hello.boot_id = boot_id_;
  hello.reset_cause = facts_.reset_cause;
  hello.board = facts_.board;
  hello.settings_from = store_.bank();
  hello.uptime_ms = now_ms;
  hello.baud = facts_.baud;
  send(hello, seq);
}

void Device::sendTelemetry(uint32_t now_ms) {
  const dynamics::CoreReport& report = core_.record();
  const dynamics::WheelSpeedsUmS wheels = core_.wheels();
  const dynamics::Sensors& sensors = core_.sensors();
  wire::Telemetry telemetry;
  telemetry.t_ms = now_ms;
  telemetry.flags = core_.flags();
  telemetry.slot = report.slot;
  telemetry.phase = report.phase;
  telemetry.program_epoch = static_cast<uint16_t>(report.program_epoch);
  telemetry.left_um_s = wheels.left;
  telemetry.right_um_s = wheels.right;
  telemetry.sensors[0] = sensors.light_front;
  telemetry.sensors[1] = sensors.light_back;
  for (uint8_t i = 0; i < dynamics::kIrSensors; ++i) {
    telemetry.sensors[2 + i] = sensors.ir[i];
  }
  telemetry.config = config_;
  telemetry.order_id = order_id_;
  telemetry.stop_id = stop_id_;
  telemetry.senses_id = senses_id_;
  send(telemetry, telemetry_seq_++);
  // Keeps the phase; skipped telemetry is counted.
  telemetry_due_ms_ += telemetry_period_ms_;
  while (reached(now_ms, telemetry_due_ms_)) {
    telemetry_due_ms_ += telemetry_period_ms_;
    ++frames_dropped_;
  }
}

void Device::sendEvent(const wire::Event& event) {
  send(event, static_cast<uint8_t>(event.number));
}

void Device::sendStep(const wire::Step& step) { send(step, static_cast<uint8_t>(step.draw_count)); }

void Device::sendState(uint32_t now_ms) {
  const dynamics::CoreReport& report = core_.record();
  wire::State state;
  state.t_ms = now_ms;
  state.program_epoch = static_cast<uint16_t>(report.program_epoch);
  state.program = report.program;
  state.program_start_ms = report.program_start_ms;
  state.held_left_um_s = report.held.left;
  state.held_right_um_s = report.held.right;
  state.reversal_count = static_cast<uint16_t>(report.reversal_count);
  state.reversal_start_ms = report.reversal_start_ms;
  state.reversal_end_ms = report.reversal_end_ms;
  state.tumble_count = static_cast<uint16_t>(report.tumble_count);
  send(state, state_seq_++);
  state_changed_ = false;
  state_due_ms_ = now_ms + kStatePeriodMs;
}

void Device::sendCounters(uint32_t now_ms) {
  const dynamics::CoreReport& report = core_.record();
  const wire::DecoderCounts& line = decoder_.counts();
  const uint16_t stack_left = static_cast<uint16_t>(board_.stackLeft() / 8U);
  wire::Counters counters;
  counters.t_ms = now_ms;
  counters.run_time_ms = core_.runTimeMs(now_ms);
  counters.draw_count = report.draw_count;
  counters.saturation_count = static_cast<uint16_t>(report.saturation_count);
  counters.frames_received = line.frames;
  counters.frames_bad = static_cast<uint16_t>(line.crc + line.malformed + line.version);
  counters.bytes_overrun = bytes_overrun_;
  counters.frames_dropped = frames_dropped_;
  counters.commands_repeated = commands_repeated_;
  counters.stack_left = static_cast<uint8_t>(stack_left < 255 ? stack_left : 255);
  send(counters, counters_seq_++);
  counters_due_ms_ = now_ms + kCountersPeriodMs;
}

void Device::sendAck(uint8_t seq, uint8_t type, const Answer& answer) {
  wire::Ack ack;
  ack.type = type;
  ack.status = answer.status;
  ack.detail = answer.detail;
  send(ack, seq);
}

void Device::sendPong(const wire::Ping& ping, uint8_t seq, uint32_t came_ms, uint16_t came_us) {
  wire::Pong pong;
  pong.token_high = ping.token_high;
  pong.token_low = ping.token_low;
  pong.t_ms = came_ms;
  pong.t_us = came_us;
  send(pong, seq);
}

void Device::sendParam(uint8_t seq, uint8_t id, int32_t value) {
  wire::ParamValue param;
  param.id = id;
  param.value = value;
  send(param, seq);
}

void Device::sendPrograms(uint8_t seq) {
  wire::Programs programs;
  for (uint8_t place = 0; place < ProgramStore::kPlaces; ++place) {
    programs.hash[place] = programs_.hash(place);
  }
  programs.running = core_.record().program;
  send(programs, seq);
}

}  // namespace firmware
}  // namespace lab
