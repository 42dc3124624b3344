// What a robot is sent, and when.
#include <algorithm>
#include <cmath>

#include "common/math/random.hpp"
#include "common/math/units.hpp"
#include "robot/wire/config.hpp"
#include "robot_bridge/protocol/robot_link.hpp"

namespace lab::bridge {
namespace {

constexpr std::int64_t kOrderPeriod_us = 180'000;  // with ticks of 20 ms: at least 5 Hz
constexpr std::int64_t kStopPeriod_us = 100'000;
constexpr std::int64_t kAskAgain_us = 300'000;
constexpr std::int64_t kPingPeriod_us = 1'000'000;
constexpr std::int64_t kFirstPings_us = 200'000;  // until the clock's rate is known
constexpr int kFirstPings = 10;
constexpr std::int64_t kAnswerTime_us = 150'000;  // at 38400 baud
constexpr std::int64_t kShortestAnswerTime_us = 50'000;
constexpr std::int64_t kStoring_us = 1'000'000;  // of COMMIT: 3.4 ms a byte
constexpr std::int64_t kReferenceBaud = 38400;
constexpr int kBitsPerByte = 10;

std::int32_t micrometres(double metres) {
  return static_cast<std::int32_t>(std::lround(metres * 1e6));
}

}  // namespace

std::int64_t RobotLink::wire_us(std::size_t payload) const {
  const auto bits = static_cast<std::int64_t>((payload + wire::kFrameOverhead) * kBitsPerByte);
  return bits * 1'000'000 / settings_.baud;
}

void RobotLink::send(const wire::Frame& frame) {
  std::uint8_t bytes[wire::kMaxFrame];
  const std::uint8_t size = wire::encode(frame, bytes);
  outgoing_.insert(outgoing_.end(), bytes, bytes + size);
  ++counters_.sent;
}

template <class Message>
void RobotLink::send(const Message& message, std::uint8_t seq) {
  wire::Frame frame;
  wire::pack(message, seq, frame);
  send(frame);
}

/// Consecutive commands have different numbers, so that none is taken for a repetition.
template <class Message>
void RobotLink::sendCommand(const Message& message, std::int64_t now) {
  wire::Frame frame;
  wire::pack(message, 0, frame);
  sendCommand(frame, now);
}

void RobotLink::sendCommand(wire::Frame& frame, std::int64_t now) {
  frame.seq = command_seq_++;
  const std::int64_t answer_time =
      frame.type == wire::Commit::kType
          ? kStoring_us
          : std::max(kShortestAnswerTime_us,
                     kAnswerTime_us * kReferenceBaud / std::int64_t{settings_.baud});
  sender_.begin(frame, now, answer_time);
  send(frame);
}

bool RobotLink::isStale(std::int64_t now) const {
  return now - heard_utime_ >
         3 * std::int64_t{settings_.telemetry_period_ms} * units::kMillisecond_us;
}

void RobotLink::tick(std::int64_t now) {
  switch (sender_.check(now)) {
    case CommandSender::Due::kSendAgain:
      ++counters_.retries;
      shortenLease(sender_.command(), now);
      send(sender_.command());
      break;
    case CommandSender::Due::kGivenUp:
      ++counters_.failed;
      if (!degraded_) note("does not answer; it is asked again with every repeat of its order");
      degraded_ = true;
      order_due_ = true;
      wait_until_ = now + kOrderPeriod_us;
      break;
    case CommandSender::Due::kNothing:
      break;
  }
  pump(now);
}

// An order that is sent again must not let the robot move for longer than the lab allows.
void RobotLink::shortenLease(wire::Frame& command, std::int64_t now) const {
  wire::Order order;
  if (!wire::unpack(command, order)) return;
  order.lease_ms = leaseLeft_ms(now);
  wire::pack(order, command.seq, command);
}

std::uint32_t RobotLink::leaseLeft_ms(std::int64_t now) const {
  return static_cast<std::uint32_t>(std::max<std::int64_t>(0, lease_end_ - now) /
                                    units::kMillisecond_us);
}

void RobotLink::pump(std::int64_t now) {
  if (!plugged_) return;
  sendStop(now);
  if (identity_in_doubt_) {
    if (now - asked_utime_ >= kAskAgain_us) {
      asked_utime_ = now;
      send(wire::GetInfo(), 0);
    }
    return;
  }
  if (sender_.isWaiting()) return;
  sendPing(now);
  // A silent robot may be in its bootloader, which must not be talked to.
  if (isStale(now) || now < wait_until_) return;
  sendNextCommand(now);
}

void RobotLink::sendStop(std::int64_t now) {
  if (stop_.id == 0 || stop_.shown || now - stop_.sent_utime < kStopPeriod_us) return;
  stop_.sent_utime = now;
  wire::Stop stop;
  stop.id = stop_.id;
  stop.action = stop_.release ? wire::Stop::kRelease : wire::Stop::kStop;
  send(stop, stop_.id);
}

void RobotLink::sendPing(std::int64_t now) {
  const std::int64_t period = pings_ < kFirstPings ? kFirstPings_us : kPingPeriod_us;
  if (now - pinged_utime_ < period) return;
  ++pings_;
  pinged_utime_ = now;
  const auto token = static_cast<std::uint64_t>(now);
  wire::Ping ping;
  ping.token_high = static_cast<std::uint32_t>(token >> 32U);
  ping.token_low = static_cast<std::uint32_t>(token);
  send(ping, 0);
}

void RobotLink::sendNextCommand(std::int64_t now) {
  if (sendPreparation(now)) return;
  convertOrder();
  if (sendWanted(now)) return;
  sendCalibration(now);
}

/// Whether the robot lacked something of what the lab wants.
bool RobotLink::sendWanted(std::int64_t now) {
  if (!wants_ || now >= lease_end_ || refused_) return false;
  // A robot that has not shown its stop yet is told nothing that could move it.
  if (stop_.id != 0 && !stop_.release && !stop_.shown) return false;
  const bool needs_settings = mode_ != robot_order_t::STAND && !standing_;
  if (needs_settings && config_ != wanted_config_) {
    sendSettings(now);
    return true;
  }
  if (!order_due_ && now - ordered_utime_ < kOrderPeriod_us) return false;
  sendOrder(now);
  return true;
}

void RobotLink::sendCalibration(std::int64_t now) {
  std::optional<wire::Frame> command = calibration_writer_.next();
  if (command) sendCommand(*command, now);
}

/// Whether there was something that comes before any order.
bool RobotLink::sendPreparation(std::int64_t now) {
  if (!seeded_) {
    // After a restart other numbers, or the same draws would come again. A real robot's boots are
    // counted by itself, also while nobody listens; a simulated one begins with its lab.
    std::string purpose = "program";
    if (!settings_.simulated) purpose += " boot " + std::to_string(hello_->boot_id);
    if (counters_.reboots > 0) purpose += " restart " + std::to_string(counters_.reboots);
    const std::uint64_t seed = deriveSeed(settings_.seed, settings_.id, purpose);
    wire::SetSeed message;
    message.high = static_cast<std::uint32_t>(seed >> 32U);
    message.low = static_cast<std::uint32_t>(seed);
    sendCommand(message, now);
    return true;
  }
  if (params_set_ < kParamsWanted) {
    wire::SetParam message;
    message.id = params_set_ == 0 ? wire::kTelemetryPeriod : wire::kStepLog;
    message.value = params_set_ == 0 ? static_cast<std::int32_t>(settings_.telemetry_period_ms) : 1;
    sendCommand(message, now);
    return true;
  }
  if (wheel_base_ == 0) {
    wire::GetParam message;
    message.id = wire::kWheelBase;
    sendCommand(message, now);
    return true;
  }
  return false;
}

/// Sends the next message that the robot lacks, or APPLY.
void RobotLink::sendSettings(std::int64_t now) {
  const auto sendIfNew = [&](const auto& message) {
    wire::Frame frame;
    wire::pack(message, 0, frame);
    const bool there = std::any_of(staged_.begin(), staged_.end(), [&](const wire::Frame& other) {
      return other.type == frame.type &&
             std::equal(frame.payload, frame.payload + frame.size, other.payload);
    });
    if (!there) sendCommand(message, now);
    return !there;
  };
  for (std::uint8_t slot = 0; slot < dynamics::kSlots; ++slot) {
    if (sendIfNew(wire::programMessage(wanted_.core, slot))) return;
  }
  if (sendIfNew(wire::lightMessage(wanted_.core))) return;
  if (sendIfNew(wire::motionMessage(wanted_.core))) return;
  wire::Apply apply;
  apply.config = wanted_config_;
  sendCommand(apply, now);
}

void RobotLink::sendOrder(std::int64_t now) {
  order_due_ = false;
  ordered_utime_ = now;
  wire::Order order;
  order.config = config_;
  order.lease_ms = leaseLeft_ms(now);
  order.id = standing_ ? 0 : order_id_;
  if (!standing_ && mode_ == robot_order_t::TABLE) order.mode = wire::Order::kTable;
  if (!standing_ && mode_ == robot_order_t::DRIVE) {
    order.mode = wire::Order::kDrive;
    order.left_um_s = micrometres(driven_.wheel_left);
    order.right_um_s = micrometres(driven_.wheel_right);
  }
  sendCommand(order, now);
}

}  // namespace lab::bridge
