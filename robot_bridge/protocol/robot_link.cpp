#include "robot_bridge/protocol/robot_link.hpp"

#include <algorithm>
#include <utility>

#include "common/math/units.hpp"
#include "robot/wire/config.hpp"

namespace lab::bridge {
namespace {

constexpr std::int64_t kOrderSpacing_us = 100'000;  // a repeated command needs no order sooner
constexpr std::int32_t kLongestJump_ms = 1'000;     // of a robot's clock, backwards: it restarted
constexpr std::int32_t kUncalibratedWheelBase_um = 75'000;  // as the firmware is built
constexpr std::size_t kTablesKept = 4;

}  // namespace

RobotLink::RobotLink(const LinkSettings& settings) : settings_(settings) {}

void RobotLink::note(const std::string& what) {
  notes_.push_back("robot " + std::to_string(settings_.id) + ": " + what);
}

std::vector<std::string> RobotLink::takeNotes() { return std::exchange(notes_, {}); }

// ---- the line ----

void RobotLink::plug(const wire::Hello& hello, std::int64_t now) {
  plugged_ = true;
  outgoing_.clear();
  sender_.forget();
  wait_until_ = 0;
  order_due_ = true;
  stop_.sent_utime = 0;
  take(hello, now);
  pump(now);
}

void RobotLink::unplug() {
  plugged_ = false;
  sender_.forget();
  outgoing_.clear();
}

// Everything the robot knew is gone, and with it the permission to move.
void RobotLink::restart() {
  if (hello_) {
    ++counters_.reboots;
    if (wants_ && !settings_.resume_after_reboot) {
      standing_ = true;
      note("restarted; it stands until it gets a new order");
    } else {
      note("restarted");
    }
    echo_ = {};
  }
  forgetState();
  clock_.reset();
  pings_ = 0;
  pinged_utime_ = 0;
  seeded_ = false;
  params_set_ = 0;
  wheel_base_ = 0;
  calibration_writer_.restart();
  stop_.shown = false;
  stop_.sent_utime = 0;
  order_due_ = true;
}

void RobotLink::forgetState() {
  view_.reset();
  staged_.clear();
  config_ = 0;
  sender_.forget();
}

/// By how much a robot's clock has gone on at least since it was last heard.
std::int32_t RobotLink::silence_ms(std::int64_t now) const {
  constexpr std::int64_t kDay_ms = 86'400'000;
  const std::int64_t silence = (now - heard_utime_) / units::kMillisecond_us;
  return static_cast<std::int32_t>(std::clamp<std::int64_t>(silence - silence / 20, 0, kDay_ms));
}

void RobotLink::take(const wire::Hello& hello, std::int64_t now) {
  // A robot that lost its memory may count its boots from the same number again: then its clock
  // tells.
  const bool began_again =
      latest_robot_ms_ &&
      msBetween(hello.uptime_ms, *latest_robot_ms_) + silence_ms(now) > kLongestJump_ms;
  heard_utime_ = now;
  if (!hello_ || hello.boot_id != hello_->boot_id || began_again) {
    restart();
  } else if (identity_in_doubt_) {
    forgetState();
  }
  hello_ = hello;
  latest_robot_ms_ = hello.uptime_ms;
  identity_in_doubt_ = false;
  clock_.hear(now, hello.uptime_ms, wire_us(wire::payloadSize<wire::Hello>()));
}

/// Something that only a restart explains. Nothing is believed or sent until HELLO has come.
void RobotLink::verifyIdentity() {
  if (identity_in_doubt_) return;
  identity_in_doubt_ = true;
  asked_utime_ = 0;
  sender_.forget();
}

void RobotLink::receive(const wire::Frame& frame, std::int64_t now) {
  ++counters_.received;
  wire::Hello hello;
  wire::Telemetry telemetry;
  wire::State state;
  wire::Step step;
  wire::Counters counters;
  wire::Pong pong;
  wire::Ack ack;
  wire::ParamValue param;
  const bool is_hello = wire::unpack(frame, hello);
  if (is_hello) take(hello, now);
  heard_utime_ = now;
  if (is_hello) {
    // It has said all that it says.
  } else if (identity_in_doubt_) {
    // What it says may be another life's.
  } else if (wire::unpack(frame, telemetry)) {
    take(telemetry, frame, now);
  } else if (wire::unpack(frame, state)) {
    view_.take(state);
  } else if (wire::unpack(frame, step)) {
    view_.take(step);
  } else if (wire::unpack(frame, counters)) {
    view_.take(counters);
  } else if (wire::unpack(frame, pong)) {
    take(pong, now);
  } else if (wire::unpack(frame, ack)) {
    take(ack, frame.seq);
  } else if (wire::unpack(frame, param)) {
    take(param, frame.seq);
  }  // EVENT says nothing that telemetry does not; other types are a newer robot's
  pump(now);
}

void RobotLink::take(const wire::Telemetry& telemetry, const wire::Frame& frame, std::int64_t now) {
  const bool jumped =
      latest_robot_ms_ && msBetween(telemetry.t_ms, *latest_robot_ms_) > kLongestJump_ms;
  const bool forgot = config_ != 0 && telemetry.config == 0;
  if (jumped || forgot) {
    verifyIdentity();
    return;
  }
  clock_.hear(now, telemetry.t_ms, wire_us(wire::payloadSize<wire::Telemetry>()));
  latest_robot_ms_ = telemetry.t_ms;
  view_.take(telemetry, frame.seq);
  config_ = telemetry.config;
  if (stop_.id != 0) {
    const bool stopped = (telemetry.flags & dynamics::kStopped) != 0;
    stop_.shown = telemetry.stop_id == stop_.id && stopped != stop_.release;
    if (stop_.shown) stop_.shown_seq = stop_.seq;
  }
  if (wants_ && !standing_ && !rejected_ && telemetry.order_id == order_id_) echo_ = ordered_;
}

void RobotLink::take(const wire::Pong& pong, std::int64_t now) {
  const std::uint64_t token = std::uint64_t{pong.token_high} << 32U | pong.token_low;
  const auto sent = static_cast<std::int64_t>(token);
  if (sent != pinged_utime_) return;  // an old one, or not ours
  counters_.round_trip_us = now - sent;
  clock_.add(sent, now, std::uint64_t{pong.t_ms} * 1000U + pong.t_us,
             wire_us(wire::payloadSize<wire::Ping>()), wire_us(wire::payloadSize<wire::Pong>()));
}

void RobotLink::take(const wire::Ack& ack, std::uint8_t seq) {
  degraded_ = false;
  if (ack.type == wire::Stop::kType) {
    if (ack.status == wire::kOk && stop_.id != 0 && seq == stop_.id) {
      stop_.shown = true;
      stop_.shown_seq = stop_.seq;
    }
    return;
  }
  const std::optional<wire::Frame> command = sender_.answer(ack.type, seq);
  if (command) finish(*command, ack);
}

void RobotLink::take(const wire::ParamValue& value, std::uint8_t seq) {
  degraded_ = false;
  if (!sender_.answer(wire::GetParam::kType, seq)) return;
  if (wheel_base_ != 0) return calibration_writer_.finish(value);
  const bool calibrated = value.value > 0 && value.value != kUncalibratedWheelBase_um;
  wheel_base_ = calibrated ? value.value * 1e-6 : settings_.wheel_base;
}

void RobotLink::finish(const wire::Frame& command, const wire::Ack& ack) {
  switch (ack.type) {
    case wire::SetSeed::kType:
      seeded_ = true;
      return;
    case wire::SetParam::kType:
      if (params_set_ == kParamsWanted) return calibration_writer_.finish(command, ack);
      ++params_set_;
      if (ack.status != wire::kOk) note("refuses parameter " + std::to_string(command.payload[0]));
      return;
    case wire::GetParam::kType:
      if (wheel_base_ != 0) return calibration_writer_.finish(command, ack);
      wheel_base_ = settings_.wheel_base;  // it does not know its own
      return;
    case wire::Commit::kType:
      calibration_writer_.finish(command, ack);
      wheel_base_ = 0;  // it may be another now
      return;
    case wire::Apply::kType:
      return finishApply(command, ack);
    case wire::Order::kType:
      return finishOrder(command, ack);
    default:
      return finishStaging(command, ack);
  }
}

void RobotLink::finishStaging(const wire::Frame& command, const wire::Ack& ack) {
  if (ack.status != wire::kOk) return refuse(ack);
  std::erase_if(staged_, [&command](const wire::Frame& other) {
    return other.type == command.type &&
           (command.type != wire::SetProgram::kType || other.payload[0] == command.payload[0]);
  });
  staged_.push_back(command);
}

void RobotLink::finishApply(const wire::Frame& command, const wire::Ack& ack) {
  if (ack.status == wire::kOk) {
    config_ = static_cast<std::uint16_t>(command.payload[0] | command.payload[1] << 8);
    order_due_ = true;
  } else if (ack.status == wire::kWrongConfig) {
    staged_.clear();  // something else than meant is staged
  } else {
    refuse(ack);
  }
}

void RobotLink::finishOrder(const wire::Frame& command, const wire::Ack& ack) {
  if (ack.status == wire::kWrongConfig) {
    verifyIdentity();  // settings do not change by themselves
  } else if (ack.status == wire::kOk && !standing_ && !rejected_ &&
             command.payload[0] == order_id_) {
    echo_ = ordered_;
  }
}

void RobotLink::refuse(const wire::Ack& ack) {
  refused_ = true;
  rejected_ = true;
  echo_ = heard_;
  note("refuses its settings (message " + std::to_string(ack.type) + ", status " +
       std::to_string(ack.status) + ", detail " + std::to_string(ack.detail) +
       "): it stands; give it an order within its limits");
}

// ---- the lab ----

void RobotLink::command(std::int64_t seq, std::int64_t instance, std::int32_t lease_ms,
                        const robot_order_t& order, std::int64_t now) {
  const Key key{seq, instance};
  lease_end_ = now + std::int64_t{std::max(0, lease_ms)} * units::kMillisecond_us;
  if (key != heard_) {
    heard_ = key;
    unconverted_ = order;
    order_due_ = true;
  } else if (now - ordered_utime_ >= kOrderSpacing_us) {
    order_due_ = true;
  }
  wait_until_ = 0;
  pump(now);
}

// The wheel base is the robot's own, so this waits until the robot has said it.
void RobotLink::convertOrder() {
  if (!unconverted_ || wheel_base_ == 0) return;
  const robot_order_t order = *std::exchange(unconverted_, std::nullopt);
  OrderSettings settings =
      settingsFrom(order, {settings_.max_wheel_speed, wheel_base_}, settings_.sensor_period);
  rejected_ = !settings.refusal.empty();
  if (rejected_) {
    note("refuses ROBOT_COMMAND " + std::to_string(heard_.seq) + ": " + settings.refusal);
    echo_ = heard_;
    return;  // what it did before goes on
  }
  standing_ = false;
  refused_ = false;
  wants_ = true;
  ordered_ = heard_;
  mode_ = order.mode;
  order_id_ = static_cast<std::uint8_t>(order_id_ % 255 + 1);
  if (mode_ == robot_order_t::DRIVE) {
    driven_ = {};
    driven_.kind = program_t::WHEELS;
    driven_.wheel_left = order.wheel_left;
    driven_.wheel_right = order.wheel_right;
  }
  // Wheels are driven under whatever settings there are; they only need some.
  const bool keeps = mode_ != robot_order_t::TABLE && wanted_config_ != 0;
  if (!keeps) {
    wanted_ = std::move(settings);
    wanted_config_ = wire::configCrc(wanted_.core);
    rememberPrograms(wanted_config_, wanted_.programs);
  }
}

void RobotLink::rememberPrograms(std::uint16_t config, const std::vector<program_t>& programs) {
  std::erase_if(tables_, [config](const ProgramTable& table) { return table.config == config; });
  tables_.push_back({config, programs});
  if (tables_.size() > kTablesKept) tables_.pop_front();
}

program_t RobotLink::programOf(std::uint16_t config, std::uint8_t slot) const {
  for (const ProgramTable& table : tables_) {
    if (table.config == config && slot < table.programs.size()) return table.programs[slot];
  }
  return {};
}

void RobotLink::stop(std::int64_t seq, bool release, std::int64_t now) {
  const bool known = stop_.id != 0 && stop_.seq == seq && stop_.release == release;
  if (!known) {
    stop_.id = static_cast<std::uint8_t>(stop_.id % 255 + 1);
    stop_.seq = seq;
    stop_.release = release;
    stop_.shown = false;
    stop_.sent_utime = 0;
  }
  pump(now);
}

void RobotLink::calibrate(std::int64_t seq, std::int64_t instance,
                          const motor_calibration_t& wanted, std::int64_t now) {
  const std::optional<wire::Ack>& failure = calibration_writer_.failure();
  if (failure) {
    note("did not take its calibration (message " + std::to_string(failure->type) + ", status " +
         std::to_string(failure->status) + "); it must stand, and the numbers be possible");
  }
  calibration_writer_.ask(seq, instance, wanted);
  pump(now);
}

}  // namespace lab::bridge
