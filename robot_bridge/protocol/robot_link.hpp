/// The host's side of the protocol with one robot, without input or output.
#pragma once

#include <array>
#include <cstdint>
#include <lab/program_id_t.hpp>
#include <lab/robot_order_t.hpp>
#include <optional>
#include <string>
#include <vector>

#include "robot/wire/messages.hpp"
#include "robot_bridge/protocol/calibration_writer.hpp"
#include "robot_bridge/protocol/clock_estimate.hpp"
#include "robot_bridge/protocol/command_sender.hpp"
#include "robot_bridge/protocol/desired_state.hpp"
#include "robot_bridge/protocol/program_loader.hpp"
#include "robot_bridge/protocol/robot_view.hpp"

namespace lab::bridge {

/// Constants of a run.
struct LinkSettings {
  std::int32_t id = 0;
  bool simulated = true;          ///< the robot's first boot is the start of the run
  std::uint64_t seed = 1;         ///< of the experiment
  double max_wheel_speed = 0.27;  ///< [m/s]
  double sensor_period = 0.02;    ///< [s]
  double wheel_base = 0.075;      ///< [m] of a robot without calibration
  bool resume_after_reboot = false;
  int baud = 38400;
  std::uint32_t telemetry_period_ms = 50;
};

/// Counts since the start of the run.
struct LinkCounters {
  std::int64_t sent = 0;      ///< frames
  std::int64_t received = 0;  ///< frames
  std::int64_t errors = 0;    ///< damaged frames received
  std::int64_t retries = 0;   ///< commands sent again
  std::int64_t failed = 0;    ///< commands given up until the next repetition of the order
  std::int64_t reboots = 0;
  std::int64_t programs_loaded = 0;
  std::int64_t loading_us = 0;     ///< all loading together
  std::int64_t round_trip_us = 0;  ///< of the last PING
};

/// Brings one robot into the desired state and keeps it there.
///
/// There is no script of messages. Whenever the line is free, the first difference between the
/// desired state and the robot's known state decides what is sent next: seed, parameters, programs,
/// settings, order. So a lost message, a replugged cable and a robot that lost its settings are
/// handled in the same way. The robot's reports take precedence over what was sent to it.
///
/// While the lease of the last ROBOT_COMMAND runs, the robot gets an order at least five times a
/// second, with the remaining lease. After a reboot the robot stands until a new order comes,
/// unless the experiment lets it resume. A stop is sent at once, before everything else, and is
/// repeated until the robot reports it.
class RobotLink {
 public:
  explicit RobotLink(const LinkSettings& settings);

  // ---- the serial line

  /// The robot has sent HELLO on a line that was just opened.
  void plug(const wire::Hello& hello, std::int64_t now);
  /// That line is closed.
  void unplug();
  [[nodiscard]] bool isPlugged() const { return plugged_; }

  /// Counts damaged frames.
  void noteErrors(std::int64_t frames) { counters_.errors += frames; }
  /// Processes a frame received at `now`.
  void receive(const wire::Frame& frame, std::int64_t now);
  /// Handles timeouts and periodic messages. To be called about every 20 ms.
  void tick(std::int64_t now);
  /// The bytes to be written; the caller removes them.
  [[nodiscard]] std::vector<std::uint8_t>& outgoing() { return outgoing_; }

  // ---- requests from the bus

  /// A ROBOT_COMMAND that contains this robot.
  void command(std::int64_t seq, std::int64_t instance, std::int32_t lease_ms,
               const robot_order_t& order, std::int64_t now);
  /// A ROBOT_STOP for this robot.
  void stop(std::int64_t seq, bool release, std::int64_t now);

  /// The virtual senses of this robot from a ROBOT_SENSES. They are sent once only, and at once
  /// unless the last ones were sent so shortly before that senses would take more than
  /// SetSenses::kMostPercent of the line. Newer ones replace those that wait.
  /// @param utime of the ROBOT_SENSES
  void sense(const std::array<dynamics::Fixed, dynamics::kSenses>& values, std::int64_t utime,
             std::int64_t now);

  /// A ROBOT_CALIBRATION that contains this robot.
  void calibrate(std::int64_t seq, std::int64_t instance, const motor_calibration_t& requested,
                 std::int64_t now);

  // ---- state of the robot

  [[nodiscard]] const LinkSettings& settings() const { return settings_; }
  [[nodiscard]] const std::optional<wire::Hello>& hello() const { return hello_; }
  [[nodiscard]] const RobotView& view() const { return view_; }
  [[nodiscard]] RobotView& view() { return view_; }
  [[nodiscard]] const ClockEstimate& clock() const { return clock_; }
  [[nodiscard]] const LinkCounters& counters() const { return counters_; }
  /// Whether the last command was given up without an answer.
  [[nodiscard]] bool isDegraded() const { return degraded_; }
  /// Time of the last frame received [us].
  [[nodiscard]] std::int64_t heardUtime() const { return heard_utime_; }

  /// The last ROBOT_COMMAND that the robot follows or has refused; 0: none.
  [[nodiscard]] std::int64_t commandSeq() const { return echo_.seq; }
  [[nodiscard]] std::int64_t commandInstance() const { return echo_.instance; }
  /// The last ROBOT_STOP that the robot has confirmed; 0: none.
  [[nodiscard]] std::int64_t stopSeq() const { return stop_.confirmed_seq; }
  /// Whether the last order was refused.
  [[nodiscard]] bool isRejected() const { return desired_.isRejected(); }
  /// The program in a slot of the settings with this CRC; hash 0 if it is not known.
  [[nodiscard]] program_id_t programOf(std::uint16_t config, std::uint8_t slot) const {
    return desired_.programOf(config, slot);
  }

  /// The ROBOT_SENSES that the robot uses.
  struct Senses {
    std::int64_t utime = 0;        ///< of the message; 0: none yet
    std::int64_t since_utime = 0;  ///< when the robot received it
  };
  [[nodiscard]] const Senses& senses() const { return senses_; }

  /// The motor calibration in the robot, once the last ROBOT_CALIBRATION is complete.
  [[nodiscard]] std::optional<motor_calibration_t> calibration() const {
    return calibration_writer_.held();
  }

  /// Messages for the user since the last call.
  [[nodiscard]] std::vector<std::string> takeNotes();

 private:
  static constexpr std::size_t kParamsWanted = 2;  ///< telemetry period, log of steps

  struct WaitingSenses {
    std::array<dynamics::Fixed, dynamics::kSenses> values{};
    std::int64_t utime = 0;  ///< of the ROBOT_SENSES
  };

  struct StopRequest {
    std::uint8_t id = 0;  ///< on the wire; 0: there was no stop
    bool release = false;
    bool confirmed = false;
    std::int64_t seq = 0;
    std::int64_t confirmed_seq = 0;
    std::int64_t sent_utime = 0;
  };

  void restart();
  void forgetState();
  void handle(const wire::Hello& hello, std::int64_t now);
  void handle(const wire::Telemetry& telemetry, const wire::Frame& frame, std::int64_t now);
  void handle(const wire::Pong& pong, std::int64_t now);
  void handle(const wire::Ack& ack, std::uint8_t seq);
  void handle(const wire::ParamValue& value, std::uint8_t seq);
  void finish(const wire::Frame& command, const wire::Ack& ack);
  void finishStaging(const wire::Frame& command, const wire::Ack& ack);
  void finishApply(const wire::Frame& command, const wire::Ack& ack);
  void finishOrder(const wire::Frame& command, const wire::Ack& ack);
  void finishLoading(const wire::Frame& command, const wire::Ack& ack);
  void refuse(const wire::Ack& ack);
  void verifyIdentity();
  [[nodiscard]] std::int32_t silence_ms(std::int64_t now) const;

  void convertOrder();
  void pump(std::int64_t now);
  void sendStop(std::int64_t now);
  void sendPing(std::int64_t now);
  void sendSenses(std::int64_t now);
  void sendNextCommand(std::int64_t now);
  bool sendPreparation(std::int64_t now);
  bool sendWanted(std::int64_t now);
  void keepRunning(std::int64_t now);
  [[nodiscard]] bool mayOrder(std::int64_t now) const;
  void sendSettings(std::int64_t now);
  bool sendProgram(std::int64_t now);
  [[nodiscard]] dynamics::CoreSettings nextSettings() const;
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

  // Known state of the robot since it was switched on.
  bool plugged_ = false;
  std::optional<wire::Hello> hello_;
  std::optional<std::uint32_t> latest_robot_ms_;  ///< [ms] last reading of its clock
  bool identity_in_doubt_ = false;
  std::int64_t asked_utime_ = 0;
  RobotView view_;
  ClockEstimate clock_;
  std::int64_t heard_utime_ = 0;
  std::int64_t pinged_utime_ = 0;
  bool ping_open_ = false;  ///< the last PING is not answered yet
  int pings_ = 0;
  bool seeded_ = false;
  std::size_t params_set_ = 0;
  double wheel_base_ = 0;            ///< [m] as reported by the robot; 0: not yet known
  std::vector<wire::Frame> staged_;  ///< those of the six settings messages that the robot has
  std::uint16_t config_ = 0;         ///< CRC of the settings in force in the robot; 0: none
  ProgramLoader loader_;
  bool clearing_ = false;  ///< its programs must be given up before it can take others
  std::array<Senses, 256> senses_sent_{};  ///< by the id on the wire
  std::uint8_t senses_id_ = 0;
  std::optional<WaitingSenses> waiting_senses_;
  std::int64_t senses_due_ = 0;  ///< no senses are sent before this time [us]
  Senses senses_;

  // Desired state.
  DesiredState desired_;
  CommandKey echo_;  ///< the ROBOT_COMMAND that the robot follows or has refused
  std::int64_t ordered_utime_ = 0;
  bool order_due_ = false;
  StopRequest stop_;

  CalibrationWriter calibration_writer_;

  CommandSender sender_;
  std::uint8_t command_seq_ = 0;
  bool degraded_ = false;
  std::int64_t wait_until_ = 0;  ///< no commands before this time, after one was given up [us]
};

}  // namespace lab::bridge
