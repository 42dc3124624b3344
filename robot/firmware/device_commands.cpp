#include "robot/firmware/device.hpp"
#include "robot/wire/config.hpp"
#include "robot/wire/crc16.hpp"

namespace lab {
namespace firmware {
namespace {

constexpr uint8_t kNoDetail = 0;
constexpr int32_t kShortestTelemetryPeriodMs = 10;
constexpr int32_t kLongestTelemetryPeriodMs = 60000L;
constexpr uint32_t kLongestLeaseMs = dynamics::RobotCore::kNoEventMs;

/// Sets a dead band. Checks the range before narrowing to a byte.
bool setDeadBand(int32_t value, uint8_t& dead_band) {
  if (value < 0 || value > 127) {
    return false;
  }
  dead_band = static_cast<uint8_t>(value);
  return true;
}

}  // namespace

void Device::handleCommand(const wire::Frame& frame, uint32_t now_ms, uint32_t came_ms,
                           uint16_t came_us) {
  if (!host_heard_) {
    host_heard_ = true;
    startReports(now_ms);
  }
  wire::Ping ping;
  if (wire::unpack(frame, ping)) {
    sendPong(ping, frame.seq, came_ms, came_us);
    return;
  }
  wire::GetInfo get_info;
  if (wire::unpack(frame, get_info)) {
    sendHello(now_ms, frame.seq);
    return;
  }
  wire::GetParam get_param;
  if (wire::unpack(frame, get_param)) {
    int32_t value = 0;
    if (readParam(get_param.id, value)) {
      sendParam(frame.seq, get_param.id, value);
    } else {
      sendAck(frame.seq, frame.type, Answer{wire::kBadValue, 0});
    }
    return;
  }

  wire::GetPrograms get_programs;
  if (wire::unpack(frame, get_programs)) {
    sendPrograms(frame.seq);
    return;
  }
  if (takeSenses(frame, now_ms)) {
    return;
  }

  const uint16_t crc = wire::crc16(frame.payload, frame.size);
  const bool repeated =
      executed_.type == frame.type && executed_.seq == frame.seq && executed_.crc == crc;
  if (repeated) {
    ++commands_repeated_;
    // A repeated STOP is executed again: stopping twice is harmless, not stopping is not.
    if (frame.type != wire::Stop::kType) {
      if (executed_.answer.status != kLater) {
        sendAck(frame.seq, frame.type, executed_.answer);
      }
      return;
    }
  }
  const Answer answer = execute(frame, now_ms);
  finishUpdate(now_ms);  // the motors before the answer, which takes time to encode
  if (answer.status != wire::kUnknownType && answer.status != wire::kBadLength) {
    executed_.type = frame.type;
    executed_.seq = frame.seq;
    executed_.crc = crc;
    executed_.answer = answer;
  }
  if (answer.status != kLater) {
    sendAck(frame.seq, frame.type, answer);
  }
}

Device::Answer Device::execute(const wire::Frame& frame, uint32_t now_ms) {
  switch (frame.type) {
    case wire::Stop::kType:
      return executeStop(frame, now_ms);
    case wire::Order::kType:
      return executeOrder(frame, now_ms);
    case wire::SetProgram::kType:
      return executeSetProgram(frame);
    case wire::SetLight::kType:
      return executeSetLight(frame);
    case wire::SetMotion::kType:
      return executeSetMotion(frame);
    case wire::Apply::kType:
      return executeApply(frame, now_ms);
    case wire::SetSeed::kType:
      return executeSetSeed(frame);
    case wire::SetParam::kType:
      return executeSetParam(frame, now_ms);
    case wire::Commit::kType:
      return executeCommit(frame);
    case wire::LoadBegin::kType:
      return executeLoadBegin(frame);
    case wire::LoadData::kType:
      return executeLoadData(frame);
    case wire::LoadEnd::kType:
      return executeLoadEnd(frame);
    case wire::Ping::kType:
    case wire::GetInfo::kType:
    case wire::GetParam::kType:
    case wire::GetPrograms::kType:
    case wire::SetSenses::kType:
      return Answer{wire::kBadLength, kNoDetail};  // with a valid length they were answered above
    default:
      return Answer{wire::kUnknownType, kNoDetail};
  }
}

Device::Answer Device::executeStop(const wire::Frame& frame, uint32_t now_ms) {
  wire::Stop stop;
  if (!wire::unpack(frame, stop)) {
    return Answer{wire::kBadLength, kNoDetail};
  }
  const bool stopped = (core_.flags() & dynamics::kStopped) != 0;
  if (stop.action == wire::Stop::kStop) {
    core_.stop(now_ms);
    if (!stopped) {
      note(now_ms, wire::kStopLatched, stop.id);
    }
  } else if (stop.action == wire::Stop::kRelease) {
    core_.clearStop(now_ms);
    if (stopped) {
      note(now_ms, wire::kStopReleased, stop.id);
    }
  } else {
    return Answer{wire::kBadValue, 1};
  }
  stop_id_ = stop.id;
  return Answer{wire::kOk, kNoDetail};
}

Device::Answer Device::executeOrder(const wire::Frame& frame, uint32_t now_ms) {
  wire::Order order;
  if (!wire::unpack(frame, order)) {
    return Answer{wire::kBadLength, kNoDetail};
  }
  if (order.mode > wire::Order::kDrive) {
    return Answer{wire::kBadValue, 1};
  }
  if (order.config != config_) {
    return Answer{wire::kWrongConfig, kNoDetail};
  }
  // Mode before lease: a renewed lease must not start with the mode from before it ended.
  switch (order.mode) {
    case wire::Order::kTable:
      core_.runPrograms(now_ms);
      break;
    case wire::Order::kDrive:
      core_.driveWheels(now_ms, order.left_um_s, order.right_um_s);
      break;
    default:
      core_.stand(now_ms);
      break;
  }
  recordDraw();
  core_.renewLease(now_ms, order.lease_ms < kLongestLeaseMs ? order.lease_ms : kLongestLeaseMs);
  // A lease that the host ends itself does not count as a silent host.
  leased_ = leased_ && order.lease_ms > 0;
  order_id_ = order.id;
  return Answer{wire::kOk, kNoDetail};
}

Device::Answer Device::executeSetProgram(const wire::Frame& frame) {
  wire::SetProgram program;
  if (!wire::unpack(frame, program)) {
    return Answer{wire::kBadLength, kNoDetail};
  }
  if (program.slot >= dynamics::kSlots) {
    return Answer{wire::kBadValue, 0};
  }
  wire::stage(program, staged_);
  return Answer{wire::kOk, kNoDetail};
}

Device::Answer Device::executeSetLight(const wire::Frame& frame) {
  wire::SetLight light;
  if (!wire::unpack(frame, light)) {
    return Answer{wire::kBadLength, kNoDetail};
  }
  wire::stage(light, staged_);
  return Answer{wire::kOk, kNoDetail};
}

Device::Answer Device::executeSetMotion(const wire::Frame& frame) {
  wire::SetMotion motion;
  if (!wire::unpack(frame, motion)) {
    return Answer{wire::kBadLength, kNoDetail};
  }
  wire::stage(motion, staged_);
  return Answer{wire::kOk, kNoDetail};
}

Device::Answer Device::executeApply(const wire::Frame& frame, uint32_t now_ms) {
  wire::Apply apply;
  if (!wire::unpack(frame, apply)) {
    return Answer{wire::kBadLength, kNoDetail};
  }
  const uint16_t config = wire::configCrc(staged_);
  if (apply.config != config) {
    return Answer{wire::kWrongConfig, kNoDetail};
  }
  const wire::ConfigFault fault = wire::firstFault(staged_);
  if (fault != wire::kNoFault) {
    return Answer{wire::kBadValue, fault};
  }
  for (uint8_t slot = 0; slot < dynamics::kSlots; ++slot) {
    if (staged_.programs[slot] != 0 &&
        programs_.placeOf(staged_.programs[slot]) == ProgramStore::kNoPlace) {
      return Answer{wire::kMissing, slot};
    }
  }
  core_.configure(now_ms, staged_);
  config_ = config;
  recalibrated_ = true;
  return Answer{wire::kOk, kNoDetail};
}

Device::Answer Device::executeSetSeed(const wire::Frame& frame) {
  wire::SetSeed set_seed;
  if (!wire::unpack(frame, set_seed)) {
    return Answer{wire::kBadLength, kNoDetail};
  }
  if (set_seed.high != seed_high_ || set_seed.low != seed_low_) {
    seed(set_seed.high, set_seed.low);
  }
  return Answer{wire::kOk, kNoDetail};
}

void Device::seed(uint32_t high, uint32_t low) {
  seed_high_ = high;
  seed_low_ = low;
  core_.seed(static_cast<uint64_t>(high) << 32 | low);
}

Device::Answer Device::executeSetParam(const wire::Frame& frame, uint32_t now_ms) {
  wire::SetParam param;
  if (!wire::unpack(frame, param)) {
    return Answer{wire::kBadLength, kNoDetail};
  }
  int32_t value = 0;
  if (!readParam(param.id, value)) {
    return Answer{wire::kBadValue, 0};
  }
  return writeParam(param.id, param.value, now_ms) ? Answer{wire::kOk, kNoDetail}
                                                   : Answer{wire::kBadValue, 1};
}

bool Device::readParam(uint8_t id, int32_t& value) const {
  switch (id) {
    case wire::kUid:
      value = static_cast<int32_t>(settings_.uid);
      return true;
    case wire::kGainLeft:
      value = settings_.left.gain_ppm;
      return true;
    case wire::kGainRight:
      value = settings_.right.gain_ppm;
      return true;
    case wire::kDeadBandLeft:
      value = settings_.left.dead_band;
      return true;
    case wire::kDeadBandRight:
      value = settings_.right.dead_band;
      return true;
    case wire::kWheelBase:
      value = settings_.wheel_base_um;
      return true;
    case wire::kTelemetryPeriod:
      value = telemetry_period_ms_;
      return true;
    case wire::kStepLog:
      value = step_log_ ? 1 : 0;
      return true;
    default:
      return false;
  }
}

// Returns false and changes nothing if the value is out of range.
bool Device::writeParam(uint8_t id, int32_t value, uint32_t now_ms) {
  Settings changed = settings_;
  switch (id) {
    case wire::kUid:
      changed.uid = static_cast<uint32_t>(value);
      break;
    case wire::kGainLeft:
      changed.left.gain_ppm = value;
      break;
    case wire::kGainRight:
      changed.right.gain_ppm = value;
      break;
    case wire::kDeadBandLeft:
      if (!setDeadBand(value, changed.left.dead_band)) {
        return false;
      }
      break;
    case wire::kDeadBandRight:
      if (!setDeadBand(value, changed.right.dead_band)) {
        return false;
      }
      break;
    case wire::kWheelBase:
      changed.wheel_base_um = value;
      break;
    case wire::kTelemetryPeriod:
      if (value != 0 && (value < kShortestTelemetryPeriodMs || value > kLongestTelemetryPeriodMs)) {
        return false;
      }
      telemetry_period_ms_ = static_cast<uint16_t>(value);
      telemetry_due_ms_ = now_ms;
      return true;
    case wire::kStepLog:
      if (value != 0 && value != 1) {
        return false;
      }
      step_log_ = value == 1;
      return true;
    default:
      return false;
  }
  if (!isValid(changed)) {
    return false;
  }
  settings_ = changed;
  recalibrated_ = true;
  return true;
}

}  // namespace firmware
}  // namespace lab
