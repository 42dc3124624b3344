#include "robot_bridge/protocol/robot_link.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

#include "common/math/random.hpp"
#include "common/math/units.hpp"
#include "robot/wire/config.hpp"

namespace lab::bridge {
namespace {

constexpr std::int64_t kOrderSpacing_us = 100'000;  // shortest time between repeated orders
// A robot whose clock goes back by more than this has restarted.
constexpr std::int32_t kLongestJump_ms = 1'000;
constexpr std::int32_t kUncalibratedWheelBase_um = 75'000;  // the firmware's default
constexpr std::int64_t kOrderPeriod_us = 180'000;           // at least 5 Hz with ticks of 20 ms
constexpr std::int64_t kStopPeriod_us = 100'000;
constexpr std::int64_t kAskAgain_us = 300'000;
constexpr std::int64_t kPingPeriod_us = 1'000'000;
constexpr std::int64_t kFirstPings_us = 200'000;  // until the rate of the clock is known
constexpr int kFirstPings = 10;
constexpr std::int64_t kAnswerTime_us = 150'000;  // at 38400 baud
constexpr std::int64_t kShortestAnswerTime_us = 50'000;
constexpr std::int64_t kStoring_us = 1'000'000;  // the EEPROM takes 3.4 ms per byte
constexpr std::int64_t kBusy_us = 100'000;
constexpr std::int64_t kReferenceBaud = 38400;
constexpr int kBitsPerByte = 10;

}  // namespace

RobotLink::RobotLink(const LinkSettings& settings)
    : settings_(settings),
      desired_(settings.id, settings.max_wheel_speed, settings.sensor_period) {}

void RobotLink::note(const std::string& what) {
  notes_.push_back("robot " + std::to_string(settings_.id) + ": " + what);
}

std::vector<std::string> RobotLink::takeNotes() { return std::exchange(notes_, {}); }

// ---- the serial line ----

void RobotLink::plug(const wire::Hello& hello, std::int64_t now) {
  plugged_ = true;
  outgoing_.clear();
  sender_.forget();
  wait_until_ = 0;
  order_due_ = true;
  stop_.sent_utime = 0;
  handle(hello, now);
  pump(now);
}

void RobotLink::unplug() {
  plugged_ = false;
  waiting_senses_.reset();
  sender_.forget();
  outgoing_.clear();
}

// The robot has lost all its state, including the permission to move.
void RobotLink::restart() {
  if (hello_) {
    ++counters_.reboots;
    if (desired_.hasOrder() && !settings_.resume_after_reboot) {
      desired_.stand();
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
  ping_open_ = false;
  seeded_ = false;
  params_set_ = 0;
  wheel_base_ = 0;
  calibration_writer_.restart();
  stop_.confirmed = false;
  stop_.sent_utime = 0;
  order_due_ = true;
}

void RobotLink::forgetState() {
  view_.reset();
  staged_.clear();
  config_ = 0;
  loader_.forget();
  clearing_ = false;
  senses_ = {};
  senses_sent_ = {};
  waiting_senses_.reset();
  sender_.forget();
}

/// A lower bound of the time that has passed on the robot's clock since its last frame.
std::int32_t RobotLink::silence_ms(std::int64_t now) const {
  constexpr std::int64_t kDay_ms = 86'400'000;
  const std::int64_t silence = (now - heard_utime_) / units::kMillisecond_us;
  return static_cast<std::int32_t>(std::clamp<std::int64_t>(silence - silence / 20, 0, kDay_ms));
}

void RobotLink::handle(const wire::Hello& hello, std::int64_t now) {
  // A robot that lost its EEPROM may repeat an old boot number; then its clock shows the restart.
  const bool clock_restarted =
      latest_robot_ms_ &&
      std::int64_t{msBetween(hello.uptime_ms, *latest_robot_ms_)} + silence_ms(now) >
          kLongestJump_ms;
  heard_utime_ = now;
  if (!hello_ || hello.boot_id != hello_->boot_id || clock_restarted) {
    restart();
  } else if (identity_in_doubt_) {
    forgetState();
  }
  hello_ = hello;
  latest_robot_ms_ = hello.uptime_ms;
  identity_in_doubt_ = false;
  clock_.addReading(now, hello.uptime_ms, wire_us(wire::payloadSize<wire::Hello>()));
}

/// Called when only a restart explains the robot's report. Until HELLO comes, its reports are
/// ignored and no commands are sent.
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
  wire::Programs programs;
  const bool is_hello = wire::unpack(frame, hello);
  if (is_hello) handle(hello, now);
  heard_utime_ = now;
  if (is_hello) {
    // Already processed.
  } else if (identity_in_doubt_) {
    // It may refer to the state before or after the restart.
  } else if (wire::unpack(frame, telemetry)) {
    handle(telemetry, frame, now);
  } else if (wire::unpack(frame, state)) {
    view_.update(state);
  } else if (wire::unpack(frame, step)) {
    view_.update(step);
  } else if (wire::unpack(frame, counters)) {
    view_.update(counters);
  } else if (wire::unpack(frame, pong)) {
    handle(pong, now);
  } else if (wire::unpack(frame, ack)) {
    handle(ack, frame.seq);
  } else if (wire::unpack(frame, param)) {
    handle(param, frame.seq);
  } else if (wire::unpack(frame, programs)) {
    if (sender_.answer(wire::GetPrograms::kType, frame.seq)) loader_.learn(programs);
  }  // EVENT repeats what telemetry shows; other types come from a newer robot
  pump(now);
}

void RobotLink::handle(const wire::Telemetry& telemetry, const wire::Frame& frame,
                       std::int64_t now) {
  const bool jumped =
      latest_robot_ms_ && msBetween(telemetry.t_ms, *latest_robot_ms_) > kLongestJump_ms;
  const bool forgot = config_ != 0 && telemetry.config == 0;
  if (jumped || forgot) {
    verifyIdentity();
    return;
  }
  clock_.addReading(now, telemetry.t_ms, wire_us(wire::payloadSize<wire::Telemetry>()));
  latest_robot_ms_ = telemetry.t_ms;
  view_.update(telemetry, frame.seq);
  config_ = telemetry.config;
  if (senses_sent_[telemetry.senses_id].utime != 0) senses_ = senses_sent_[telemetry.senses_id];
  if (stop_.id != 0) {
    const bool stopped = (telemetry.flags & dynamics::kStopped) != 0;
    stop_.confirmed = telemetry.stop_id == stop_.id && stopped != stop_.release;
    if (stop_.confirmed) stop_.confirmed_seq = stop_.seq;
  }
  if (desired_.isInForce(telemetry.order_id)) echo_ = desired_.active();
}

void RobotLink::handle(const wire::Pong& pong, std::int64_t now) {
  const std::uint64_t token = std::uint64_t{pong.token_high} << 32U | pong.token_low;
  const auto sent = static_cast<std::int64_t>(token);
  // The answer to another PING, or a second one: each PING gives one sample of the clock.
  if (!ping_open_ || sent != pinged_utime_) return;
  ping_open_ = false;
  counters_.round_trip_us = now - sent;
  clock_.add(sent, now, std::uint64_t{pong.t_ms} * 1000U + pong.t_us,
             wire_us(wire::payloadSize<wire::Ping>()), wire_us(wire::payloadSize<wire::Pong>()));
}

void RobotLink::handle(const wire::Ack& ack, std::uint8_t seq) {
  degraded_ = false;
  if (ack.type == wire::Stop::kType) {
    if (ack.status == wire::kOk && stop_.id != 0 && seq == stop_.id) {
      stop_.confirmed = true;
      stop_.confirmed_seq = stop_.seq;
    }
    return;
  }
  const std::optional<wire::Frame> command = sender_.answer(ack.type, seq);
  if (command) finish(*command, ack);
}

void RobotLink::handle(const wire::ParamValue& value, std::uint8_t seq) {
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
      wheel_base_ = settings_.wheel_base;  // the robot has no such parameter
      return;
    case wire::Commit::kType:
      calibration_writer_.finish(command, ack);
      wheel_base_ = 0;  // it may have changed
      return;
    case wire::Apply::kType:
      return finishApply(command, ack);
    case wire::Order::kType:
      return finishOrder(command, ack);
    case wire::LoadBegin::kType:
    case wire::LoadData::kType:
    case wire::LoadEnd::kType:
      return finishLoading(command, ack);
    case wire::GetPrograms::kType:
      return refuse(ack);  // the robot has no programs
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
    clearing_ = false;
    order_due_ = true;
  } else if (ack.status == wire::kWrongConfig) {
    staged_.clear();  // the staged settings are not the desired ones
  } else if (ack.status == wire::kMissing) {
    loader_.forget();
    staged_.clear();
  } else {
    refuse(ack);
  }
}

void RobotLink::finishLoading(const wire::Frame& command, const wire::Ack& ack) {
  switch (loader_.finish(command, ack)) {
    case ProgramLoader::Result::kGoesOn:
      return;
    case ProgramLoader::Result::kLoaded:
      ++counters_.programs_loaded;
      counters_.loading_us += heard_utime_ - loader_.begunUtime();
      return;
    case ProgramLoader::Result::kBusy:
      wait_until_ = heard_utime_ + kBusy_us;
      return;
    case ProgramLoader::Result::kNoPlace:
      if (!clearing_) {
        clearing_ = true;
        return;
      }
      return refuse(ack);
    case ProgramLoader::Result::kFailed:
      return refuse(ack);
  }
}

void RobotLink::finishOrder(const wire::Frame& command, const wire::Ack& ack) {
  if (ack.status == wire::kWrongConfig) {
    verifyIdentity();  // only a restart explains that the settings are gone
  } else if (ack.status == wire::kOk && desired_.isInForce(command.payload[0])) {
    echo_ = desired_.active();
  }
}

void RobotLink::refuse(const wire::Ack& ack) {
  desired_.refuse();
  echo_ = desired_.received();
  note("refuses its settings (message " + std::to_string(ack.type) + ", status " +
       std::to_string(ack.status) + ", detail " + std::to_string(ack.detail) +
       "): it stands; give it an order within its limits");
}

// ---- requests from the bus ----

void RobotLink::command(std::int64_t seq, std::int64_t instance, std::int32_t lease_ms,
                        const robot_order_t& order, std::int64_t now) {
  const bool is_new = desired_.command({seq, instance}, lease_ms, order, now);
  if (is_new || now - ordered_utime_ >= kOrderSpacing_us) order_due_ = true;
  wait_until_ = 0;
  pump(now);
}

void RobotLink::convertOrder() {
  if (wheel_base_ == 0) return;
  const std::string refusal = desired_.convert(wheel_base_);
  if (refusal.empty()) return;
  note("refuses ROBOT_COMMAND " + std::to_string(desired_.received().seq) + ": " + refusal);
  echo_ = desired_.received();
}

void RobotLink::stop(std::int64_t seq, bool release, std::int64_t now) {
  const bool known = stop_.id != 0 && stop_.seq == seq && stop_.release == release;
  if (!known) {
    stop_.id = static_cast<std::uint8_t>(stop_.id % 255 + 1);
    stop_.seq = seq;
    stop_.release = release;
    stop_.confirmed = false;
    stop_.sent_utime = 0;
  }
  pump(now);
}

void RobotLink::sense(const std::array<dynamics::Fixed, dynamics::kSenses>& values,
                      std::int64_t utime, std::int64_t now) {
  if (!plugged_ || identity_in_doubt_ || isStale(now)) return;
  waiting_senses_ = WaitingSenses{values, utime};
  pump(now);
}

void RobotLink::calibrate(std::int64_t seq, std::int64_t instance,
                          const motor_calibration_t& requested, std::int64_t now) {
  const std::optional<wire::Ack>& failure = calibration_writer_.failure();
  if (failure) {
    note("did not accept its calibration (message " + std::to_string(failure->type) + ", status " +
         std::to_string(failure->status) + "); it must stand, and the values must be in range");
  }
  calibration_writer_.request(seq, instance, requested);
  pump(now);
}

// ---- sending ----

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

/// Consecutive commands get different seqs, so that the robot takes none for a repetition.
template <class Message>
void RobotLink::sendCommand(const Message& message, std::int64_t now) {
  wire::Frame frame;
  wire::pack(message, 0, frame);
  sendCommand(frame, now);
}

void RobotLink::sendCommand(wire::Frame& frame, std::int64_t now) {
  frame.seq = command_seq_++;
  const std::int64_t answer_time =
      frame.type == wire::Commit::kType || frame.type == wire::LoadEnd::kType
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

// An order that is sent again must not extend the lease.
void RobotLink::shortenLease(wire::Frame& command, std::int64_t now) const {
  wire::Order order;
  if (!wire::unpack(command, order)) return;
  order.lease_ms = desired_.leaseLeft_ms(now);
  wire::pack(order, command.seq, command);
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
  keepRunning(now);
  if (!sender_.isWaiting()) {
    sendPing(now);
    // A silent robot may be in its bootloader, which bytes would keep from starting the program.
    if (!isStale(now) && now >= wait_until_) sendNextCommand(now);
  }
  sendSenses(now);
}

/// More than the line takes would be lost, and the orders behind it with it.
void RobotLink::sendSenses(std::int64_t now) {
  if (!waiting_senses_ || now < senses_due_) return;
  const WaitingSenses waiting = *std::exchange(waiting_senses_, std::nullopt);
  if (isStale(now)) return;
  const std::int64_t duration_us = wire_us(wire::payloadSize<wire::SetSenses>());
  senses_due_ = now + duration_us * 100 / wire::SetSenses::kMostPercent;
  senses_id_ = static_cast<std::uint8_t>(senses_id_ % 255 + 1);
  wire::SetSenses message;
  message.id = senses_id_;
  std::copy(waiting.values.begin(), waiting.values.end(), message.sense);
  senses_sent_[senses_id_] = {waiting.utime, now + duration_us};
  send(message, 0);
}

void RobotLink::sendStop(std::int64_t now) {
  if (stop_.id == 0 || stop_.confirmed || now - stop_.sent_utime < kStopPeriod_us) return;
  stop_.sent_utime = now;
  wire::Stop stop;
  stop.id = stop_.id;
  stop.action = stop_.release ? wire::Stop::kRelease : wire::Stop::kStop;
  send(stop, stop_.id);
}

/// Loading programs takes seconds. Until their settings are in force, a robot that runs programs
/// goes on with those that it has. The order is not answered for: another one follows.
void RobotLink::keepRunning(std::int64_t now) {
  const std::optional<RobotSnapshot>& snapshot = view_.snapshot();
  const bool replaces = desired_.needsSettings() && config_ != 0 && config_ != desired_.config();
  if (!replaces || !snapshot || snapshot->telemetry.slot >= dynamics::kSlots || !mayOrder(now) ||
      isStale(now) || now - ordered_utime_ < kOrderPeriod_us) {
    return;
  }
  ordered_utime_ = now;
  wire::Order order = desired_.orderMessage(config_, now);
  order.id = 0;  // it is not the order that the robot is to confirm
  send(order, command_seq_++);
}

void RobotLink::sendPing(std::int64_t now) {
  const std::int64_t period = pings_ < kFirstPings ? kFirstPings_us : kPingPeriod_us;
  if (now - pinged_utime_ < period) return;
  ++pings_;
  pinged_utime_ = now;
  ping_open_ = true;
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

/// Whether there is an order that the robot may get. Until it has confirmed its stop, it is sent
/// nothing that could move it.
bool RobotLink::mayOrder(std::int64_t now) const {
  const bool stopping = stop_.id != 0 && !stop_.release && !stop_.confirmed;
  return desired_.hasOrder() && !desired_.leaseExpired(now) && !desired_.isRefused() && !stopping;
}

/// Sends settings or order if the robot needs them. @return whether something was sent
bool RobotLink::sendWanted(std::int64_t now) {
  if (!mayOrder(now)) return false;
  if (desired_.needsSettings() && config_ != desired_.config()) {
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

/// Sends what must precede any order. @return whether something was sent
bool RobotLink::sendPreparation(std::int64_t now) {
  if (!seeded_) {
    // The seed includes the restarts, so that draws do not repeat after a restart. A real robot
    // counts its boots itself, also without a host; a simulated one starts with the run.
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

/// The desired settings, or those without programs while their places are needed.
dynamics::CoreSettings RobotLink::nextSettings() const {
  dynamics::CoreSettings settings = desired_.settings();
  if (clearing_) std::fill(std::begin(settings.programs), std::end(settings.programs), 0U);
  return settings;
}

/// Sends the next message that brings a missing program into the robot. @return whether one is
/// missing
bool RobotLink::sendProgram(std::int64_t now) {
  for (const std::uint32_t hash : desired_.settings().programs) {
    if (hash == 0 || loader_.has(hash)) continue;
    const program_t* program = desired_.definition(hash);
    if (program == nullptr) continue;  // no settings contain a hash without its program
    if (!loader_.isKnown()) {
      sendCommand(wire::GetPrograms(), now);
    } else {
      wire::Frame frame = loader_.next(hash, program->code, now);
      sendCommand(frame, now);
    }
    return true;
  }
  return false;
}

/// Sends the next settings message or program that the robot lacks, or APPLY. Programs come after
/// the staging of their slots, which keeps the robot from overwriting them.
void RobotLink::sendSettings(std::int64_t now) {
  const dynamics::CoreSettings settings = nextSettings();
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
    if (sendIfNew(wire::programMessage(settings, slot))) return;
  }
  if (!clearing_ && sendProgram(now)) return;
  if (sendIfNew(wire::lightMessage(settings))) return;
  if (sendIfNew(wire::motionMessage(settings))) return;
  wire::Apply apply;
  apply.config = wire::configCrc(settings);
  sendCommand(apply, now);
}

void RobotLink::sendOrder(std::int64_t now) {
  order_due_ = false;
  ordered_utime_ = now;
  sendCommand(desired_.orderMessage(config_, now), now);
}

}  // namespace lab::bridge
