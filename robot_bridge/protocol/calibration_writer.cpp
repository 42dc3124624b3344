#include "robot_bridge/protocol/calibration_writer.hpp"

#include <cmath>

#include "robot/dynamics/motor.hpp"
#include "robot/wire/fields.hpp"

namespace lab::bridge {
namespace {

constexpr std::array<std::uint8_t, 5> kIds = {
    wire::kGainLeft, wire::kGainRight, wire::kDeadBandLeft, wire::kDeadBandRight, wire::kWheelBase};
constexpr double kMillion = 1e6;

/// Rounds; values that do not fit become -1, which the robot refuses.
std::int32_t rounded(double value) {
  return std::abs(value) < 2e9 ? static_cast<std::int32_t>(std::lround(value)) : -1;
}

}  // namespace

void CalibrationWriter::request(std::int64_t seq, std::int64_t instance,
                                const motor_calibration_t& requested) {
  const bool known = seq == seq_ && instance == instance_;
  if (known && (step_ != kDone || fulfilled_)) return;
  seq_ = seq;
  instance_ = instance;
  robot_id_ = requested.robot_id;
  requested_ = {rounded(requested.gain_left * kMillion), rounded(requested.gain_right * kMillion),
                rounded(requested.dead_band_left * dynamics::kMaxDuty),
                rounded(requested.dead_band_right * dynamics::kMaxDuty),
                rounded(requested.wheel_base * kMillion)};
  begin_ = requested.gain_left == 0 ? kRead : 0;
  step_ = begin_;
  fulfilled_ = false;
  failure_.reset();
}

void CalibrationWriter::restart() {
  if (step_ < kDone) step_ = begin_;
}

std::optional<wire::Frame> CalibrationWriter::next() const {
  wire::Frame frame;
  if (step_ < kCommit) {
    wire::SetParam message;
    message.id = kIds[step_];
    message.value = requested_[step_];
    wire::pack(message, 0, frame);
  } else if (step_ == kCommit) {
    wire::pack(wire::Commit(), 0, frame);
  } else if (step_ < kDone) {
    wire::GetParam message;
    message.id = kIds[step_ - kRead];
    wire::pack(message, 0, frame);
  } else {
    return std::nullopt;
  }
  return frame;
}

void CalibrationWriter::finish(const wire::Frame& command, const wire::Ack& ack) {
  const std::optional<wire::Frame> current = next();
  if (!current || current->type != command.type || current->payload[0] != command.payload[0])
    return;
  if (ack.status == wire::kOk) {
    ++step_;
    return;
  }
  failure_ = ack;
  step_ = kDone;
}

void CalibrationWriter::finish(const wire::ParamValue& value) {
  if (step_ < kRead || step_ >= kDone || kIds[step_ - kRead] != value.id) return;
  held_[step_ - kRead] = value.value;
  ++step_;
  fulfilled_ = step_ == kDone;
}

std::optional<motor_calibration_t> CalibrationWriter::held() const {
  if (!fulfilled_) return std::nullopt;
  motor_calibration_t message{};
  message.robot_id = robot_id_;
  message.gain_left = held_[0] / kMillion;
  message.gain_right = held_[1] / kMillion;
  message.dead_band_left = static_cast<double>(held_[2]) / dynamics::kMaxDuty;
  message.dead_band_right = static_cast<double>(held_[3]) / dynamics::kMaxDuty;
  message.wheel_base = held_[4] / kMillion;
  return message;
}

}  // namespace lab::bridge
