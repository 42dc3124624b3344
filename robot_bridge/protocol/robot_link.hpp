/// One robot's side of the protocol: what the lab wants of it and what it does, as pure code.
#pragma once

#include <cstdint>
#include <lab/program_t.hpp>
#include <lab/robot_order_t.hpp>
#include <optional>
#include <string>
#include <vector>

#include "robot/wire/messages.hpp"
#include "robot_bridge/protocol/calibration_writer.hpp"
#include "robot_bridge/protocol/clock_estimate.hpp"
#include "robot_bridge/protocol/command_sender.hpp"
#include "robot_bridge/protocol/desired_state.hpp"
#include "robot_bridge/protocol/robot_view.hpp"

namespace lab::bridge {

/// What does not change during a run.
struct LinkSettings {
  std::int32_t id = 0;
  bool simulated = true;          ///< it boots with its lab, and never before
  std::uint64_t seed = 1;         ///< of the experiment
  double max_wheel_speed = 0.27;  ///< [m/s]
  double sensor_period = 0.02;    ///< [s]
  double wheel_base = 0.075;      ///< [m] of a robot that was not calibrated
  bool resume_after_reboot = false;
  int baud = 38400;
  std::uint32_t telemetry_period_ms = 50;
};

/// Over the whole run.
struct LinkCounters {
  std::int64_t sent = 0;      ///< frames
  std::int64_t received = 0;  ///< frames
  std::int64_t errors = 0;    ///< frames that came damaged
  std::int64_t retries = 0;   ///< commands sent again
  std::int64_t failed = 0;    ///< commands given up; the next repeat of the state tries again
  std::int64_t reboots = 0;
  std::int64_t round_trip_us = 0;  ///< of the last PING
};

/// Brings one robot to where the lab wants it and keeps it there.
///
/// There is no script of messages. Whenever the line is free, the first difference between what is
/// wanted and what the robot is known to have decides what is sent next: seed, parameters,
/// settings, order. So a lost message, a replugged cable and a robot that lost its settings are all
/// the same case. Everything the robot says of itself outranks what it was told.
///
/// The robot gets an order at least five times a second while the lab's ROBOT_COMMAND is alive,
/// with what remains of its lease. After a reboot the robot stands until the lab gives a NEW order,
/// unless the experiment lets it resume. A stop goes out at once, whatever else is under way, and
/// again until the robot shows it.
class RobotLink {
 public:
  explicit RobotLink(const LinkSettings& settings);

  // ---- the line

  /// The robot has said HELLO on a line that was just opened.
  void plug(const wire::Hello& hello, std::int64_t now);
  /// That line is closed.
  void unplug();
  [[nodiscard]] bool isPlugged() const { return plugged_; }

  /// Counts frames that came damaged.
  void noteErrors(std::int64_t frames) { counters_.errors += frames; }
  /// Takes a frame that came in at `now`.
  void receive(const wire::Frame& frame, std::int64_t now);
  /// Repeats, gives up, pings. To be called every 20 ms or so.
  void tick(std::int64_t now);
  /// The bytes to be written; the caller takes them away.
  [[nodiscard]] std::vector<std::uint8_t>& outgoing() { return outgoing_; }

  // ---- the lab

  /// A ROBOT_COMMAND with this robot in it.
  void command(std::int64_t seq, std::int64_t instance, std::int32_t lease_ms,
               const robot_order_t& order, std::int64_t now);
  /// A ROBOT_STOP that means this robot.
  void stop(std::int64_t seq, bool release, std::int64_t now);

  /// A ROBOT_CALIBRATION with this robot in it.
  void calibrate(std::int64_t seq, std::int64_t instance, const motor_calibration_t& wanted,
                 std::int64_t now);

  // ---- what is known

  [[nodiscard]] const LinkSettings& settings() const { return settings_; }
  [[nodiscard]] const std::optional<wire::Hello>& hello() const { return hello_; }
  [[nodiscard]] const RobotView& view() const { return view_; }
  [[nodiscard]] RobotView& view() { return view_; }
  [[nodiscard]] const ClockEstimate& clock() const { return clock_; }
  [[nodiscard]] const LinkCounters& counters() const { return counters_; }
  /// Commands go unanswered.
  [[nodiscard]] bool isDegraded() const { return degraded_; }
  /// When the last frame came [us].
  [[nodiscard]] std::int64_t heardUtime() const { return heard_utime_; }

  /// The last ROBOT_COMMAND that the robot obeys (or has refused), 0: none.
  [[nodiscard]] std::int64_t commandSeq() const { return echo_.seq; }
  [[nodiscard]] std::int64_t commandInstance() const { return echo_.instance; }
  /// The last ROBOT_STOP that the robot has shown, 0: none.
  [[nodiscard]] std::int64_t stopSeq() const { return stop_.shown_seq; }
  /// Whether the last order was refused.
  [[nodiscard]] bool isRejected() const { return desired_.isRejected(); }
  /// What the robot runs in a slot of the settings with this CRC; NONE where that is not known.
  [[nodiscard]] program_t programOf(std::uint16_t config, std::uint8_t slot) const {
    return desired_.programOf(config, slot);
  }
  /// What it runs while its wheels are driven by hand.
  [[nodiscard]] const program_t& driven() const { return desired_.driven(); }

  /// The motor calibration that the robot holds, once the last ROBOT_CALIBRATION is fulfilled.
  [[nodiscard]] std::optional<motor_calibration_t> calibration() const {
    return calibration_writer_.held();
  }

  /// What somebody should know, in words, since the last call.
  [[nodiscard]] std::vector<std::string> takeNotes();

 private:
  static constexpr std::size_t kParamsWanted = 2;  ///< telemetry period, log of steps

  struct StopRequest {
    std::uint8_t id = 0;  ///< on the wire, 0: there was none
    bool release = false;
    bool shown = false;
    std::int64_t seq = 0;
    std::int64_t shown_seq = 0;
    std::int64_t sent_utime = 0;
  };

  void restart();
  void forgetState();
  void take(const wire::Hello& hello, std::int64_t now);
  void take(const wire::Telemetry& telemetry, const wire::Frame& frame, std::int64_t now);
  void take(const wire::Pong& pong, std::int64_t now);
  void take(const wire::Ack& ack, std::uint8_t seq);
  void take(const wire::ParamValue& value, std::uint8_t seq);
  void finish(const wire::Frame& command, const wire::Ack& ack);
  void finishStaging(const wire::Frame& command, const wire::Ack& ack);
  void finishApply(const wire::Frame& command, const wire::Ack& ack);
  void finishOrder(const wire::Frame& command, const wire::Ack& ack);
  void refuse(const wire::Ack& ack);
  void verifyIdentity();
  [[nodiscard]] std::int32_t silence_ms(std::int64_t now) const;

  void convertOrder();
  void pump(std::int64_t now);
  void sendStop(std::int64_t now);
  void sendPing(std::int64_t now);
  void sendNextCommand(std::int64_t now);
  bool sendPreparation(std::int64_t now);
  bool sendWanted(std::int64_t now);
  void sendSettings(std::int64_t now);
  void sendOrder(std::int64_t now);
  void shortenLease(wire::Frame& command, std::int64_t now) const;
  void sendCalibration(std::int64_t now);
  template <class Message>
  void send(const Message& message, std::uint8_t seq);
  void send(const wire::Frame& frame);
  template <class Message>
  void sendCommand(const Message& message, std::int64_t now);
  void sendCommand(wire::Frame& frame, std::int64_t now);
  [[nodiscard]] std::int64_t wire_us(std::size_t payload) const;
  [[nodiscard]] bool isStale(std::int64_t now) const;
  void note(const std::string& what);

  LinkSettings settings_;
  LinkCounters counters_;
  std::vector<std::uint8_t> outgoing_;
  std::vector<std::string> notes_;

  // The robot, since it was switched on.
  bool plugged_ = false;
  std::optional<wire::Hello> hello_;
  std::optional<std::uint32_t> latest_robot_ms_;  ///< [ms] the latest that its clock has said
  bool identity_in_doubt_ = false;
  std::int64_t asked_utime_ = 0;
  RobotView view_;
  ClockEstimate clock_;
  std::int64_t heard_utime_ = 0;
  std::int64_t pinged_utime_ = 0;
  int pings_ = 0;
  bool seeded_ = false;
  std::size_t params_set_ = 0;
  double wheel_base_ = 0;            ///< [m] as the robot says, 0: not yet asked
  std::vector<wire::Frame> staged_;  ///< the six messages of the settings that the robot has
  std::uint16_t config_ = 0;         ///< of the settings in force there, 0: none

  // What the lab wants.
  DesiredState desired_;
  CommandKey echo_;  ///< the ROBOT_COMMAND that the robot follows or has refused
  std::int64_t ordered_utime_ = 0;
  bool order_due_ = false;
  StopRequest stop_;

  CalibrationWriter calibration_writer_;

  CommandSender sender_;
  std::uint8_t command_seq_ = 0;
  bool degraded_ = false;
  std::int64_t wait_until_ = 0;  ///< after a failure
};

}  // namespace lab::bridge
