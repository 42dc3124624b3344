#pragma once

#include <stdint.h>

#include "robot/dynamics/motor.hpp"
#include "robot/dynamics/robot_core.hpp"
#include "robot/firmware/board.hpp"
#include "robot/firmware/program_store.hpp"
#include "robot/firmware/ring.hpp"
#include "robot/firmware/settings.hpp"
#include "robot/wire/frame.hpp"
#include "robot/wire/messages.hpp"

/// Marks functions with large local variables. Inlined, they would enlarge their caller's stack
/// frame, and the chip's stack has 400 bytes.
#define LAB_NOINLINE __attribute__((noinline))

namespace lab {
namespace firmware {

/// Major * 256 + minor, as in HELLO.
constexpr uint16_t kFirmwareVersion = 0x0200;

/// Whether a time has come, on a clock that wraps around.
inline bool reached(uint32_t now_ms, uint32_t due_ms) {
  return static_cast<int32_t>(now_ms - due_ms) >= 0;
}

/// Internal status of an answer: it follows when the command is complete.
constexpr uint8_t kLater = 255;

constexpr uint16_t kHelloPeriodMs = 1000;
constexpr uint16_t kStatePeriodMs = 250;
constexpr uint16_t kCountersPeriodMs = 1000;
constexpr uint16_t kDefaultTelemetryPeriodMs = 50;

/// What the electronics report at boot.
struct BootFacts {
  uint8_t reset_cause = 0;  ///< wire::ResetCause
  uint8_t board = 0;        ///< as in wire::Hello
  uint32_t baud = 0;
  uint32_t build = 0;  ///< first 8 hex digits of the commit; 0: unknown
};

/// The robot's firmware without its electronics: RobotCore controlled by the wire protocol, with
/// failsafe, stop latch, settings, telemetry and the record of all draws. The chip has one; sim_svc
/// has one per simulated robot on the wire.
///
/// Calls must not go back in time. After each call the motors (Board::setMotors) are set as the
/// core requires.
///
/// Before the first valid frame from a host, the robot sends only HELLO. Answers are queued at
/// once. Reports are sent one at a time while the queue is empty, so that an answer waits for at
/// most one other frame.
///
/// This is one class in four files. Its parts share most of the state, and classes of their own
/// would need references to each other, which cost flash and RAM on the chip.
class Device {
 public:
  Device(Board& board, const BootFacts& facts);

  /// To be called once, first: motors off, settings from the store, HELLO.
  void boot(uint32_t now_ms);

  /// Processes one byte from the line, with the robot's time of its reception (the only time that
  /// may be earlier than that of the last call). A command that it completes is executed at once
  /// and answered.
  void receive(uint32_t now_ms, uint16_t now_us, uint8_t byte);

  /// Counts bytes that were lost before receive().
  void noteOverrun(uint16_t bytes);

  /// To be called after boot() if the watchdog has restarted the program because it hung.
  void noteWatchdog(uint32_t now_ms);

  /// Whether a scan of the sensors is due, whose readings are then passed to sense().
  bool scanDue(uint32_t now_ms) const;
  void sense(uint32_t now_ms, const dynamics::Sensors& sensors);

  /// To be called every millisecond: draws, lease, motors and reports.
  void tick(uint32_t now_ms);

  const dynamics::RobotCore& core() const { return core_; }
  const Settings& settings() const { return settings_; }
  const ProgramStore& programs() const { return programs_; }

 private:
  /// Result of a command.
  struct Answer {
    uint8_t status;
    uint8_t detail;
  };

  /// The last executed command, to recognise its repetition.
  struct Executed {
    uint8_t type = 0;  ///< 0: none yet
    uint8_t seq = 0;
    uint16_t crc = 0;  ///< of the payload
    Answer answer = {0, 0};
  };

  // device.cpp
  void advance(uint32_t now_ms);
  LAB_NOINLINE void finishUpdate(uint32_t now_ms);
  LAB_NOINLINE void recordDraw();
  void driveMotors();
  void note(uint32_t now_ms, wire::EventCode code, uint32_t data);
  void startBootCounter();

  // device_commands.cpp
  LAB_NOINLINE void handleCommand(const wire::Frame& frame, uint32_t now_ms, uint32_t came_ms,
                                  uint16_t came_us);
  Answer execute(const wire::Frame& frame, uint32_t now_ms);
  LAB_NOINLINE Answer executeSetProgram(const wire::Frame& frame);
  LAB_NOINLINE Answer executeSetLight(const wire::Frame& frame);
  LAB_NOINLINE Answer executeSetMotion(const wire::Frame& frame);
  LAB_NOINLINE Answer executeApply(const wire::Frame& frame, uint32_t now_ms);
  LAB_NOINLINE Answer executeOrder(const wire::Frame& frame, uint32_t now_ms);
  LAB_NOINLINE Answer executeStop(const wire::Frame& frame, uint32_t now_ms);
  LAB_NOINLINE Answer executeSetSeed(const wire::Frame& frame);
  LAB_NOINLINE Answer executeSetParam(const wire::Frame& frame, uint32_t now_ms);
  bool readParam(uint8_t id, int32_t& value) const;
  bool writeParam(uint8_t id, int32_t value, uint32_t now_ms);
  void seed(uint32_t high, uint32_t low);

  // device_storing.cpp
  LAB_NOINLINE Answer executeCommit(const wire::Frame& frame);
  LAB_NOINLINE Answer executeLoadBegin(const wire::Frame& frame);
  LAB_NOINLINE Answer executeLoadData(const wire::Frame& frame);
  LAB_NOINLINE Answer executeLoadEnd(const wire::Frame& frame);
  LAB_NOINLINE bool takeSenses(const wire::Frame& frame, uint32_t now_ms);
  uint8_t freePlace() const;
  bool isUsed(uint32_t hash) const;
  void answerLater(const wire::Frame& frame);
  LAB_NOINLINE void continueStoring(uint32_t now_ms);

  // device_reports.cpp
  LAB_NOINLINE void report(uint32_t now_ms);
  void startReports(uint32_t now_ms);
  bool telemetryDue(uint32_t now_ms) const;
  bool stateDue(uint32_t now_ms) const;
  bool sendInTurn(uint8_t turn, uint32_t now_ms);
  LAB_NOINLINE void sendHello(uint32_t now_ms, uint8_t seq);
  LAB_NOINLINE void sendTelemetry(uint32_t now_ms);
  LAB_NOINLINE void sendState(uint32_t now_ms);
  LAB_NOINLINE void sendCounters(uint32_t now_ms);
  LAB_NOINLINE void sendAck(uint8_t seq, uint8_t type, const Answer& answer);
  LAB_NOINLINE void sendEvent(const wire::Event& event);
  LAB_NOINLINE void sendStep(const wire::Step& step);
  LAB_NOINLINE void sendPong(const wire::Ping& ping, uint8_t seq, uint32_t came_ms,
                             uint16_t came_us);
  LAB_NOINLINE void sendParam(uint8_t seq, uint8_t id, int32_t value);
  LAB_NOINLINE void sendPrograms(uint8_t seq);
  template <class Message>
  void send(const Message& message, uint8_t seq);
  LAB_NOINLINE void transmit(const wire::Frame& frame);

  Board& board_;
  BootFacts facts_;
  ProgramStore programs_;
  dynamics::RobotCore core_;
  dynamics::CoreSettings staged_;
  Settings settings_;
  SettingsStore store_;
  wire::Decoder decoder_;

  uint32_t now_ms_ = 0;  ///< of the last call
  uint32_t scan_due_ms_ = 0;
  uint16_t boot_id_ = 0;
  uint16_t config_ = 0;  ///< CRC of the settings in force; 0: none
  uint32_t seed_high_ = 0;
  uint32_t seed_low_ = 0;
  uint8_t order_id_ = 0;
  uint8_t stop_id_ = 0;
  bool host_heard_ = false;
  bool leased_ = false;
  uint8_t senses_id_ = 0;
  uint8_t storing_ = 0;  ///< type of the command in progress: COMMIT or LOAD_END; 0: none
  uint8_t storing_seq_ = 0;
  Executed executed_;

  uint32_t draws_recorded_ = 0;
  dynamics::WheelSpeedsUmS driven_wheels_;  ///< the speeds that the duties were computed for
  bool recalibrated_ = true;                ///< the duties must be computed again
  uint32_t full_left_ = 0;                  ///< speed at full duty [um/s]
  uint32_t full_right_ = 0;
  int16_t duty_left_ = 0;
  int16_t duty_right_ = 0;

  bool step_log_ = true;
  uint8_t turn_ = 0;  ///< which of the reports that take turns was sent last
  bool state_changed_ = false;
  uint16_t telemetry_period_ms_ = kDefaultTelemetryPeriodMs;
  uint8_t telemetry_seq_ = 0;
  uint8_t state_seq_ = 0;
  uint8_t counters_seq_ = 0;
  uint32_t hello_due_ms_ = 0;
  uint32_t telemetry_due_ms_ = 0;
  uint32_t state_due_ms_ = 0;
  uint32_t counters_due_ms_ = 0;
  uint16_t known_epoch_ = 0;
  uint16_t known_reversals_ = 0;
  uint32_t known_reversal_end_ms_ = 0;

  uint16_t event_number_ = 0;
  uint16_t bytes_overrun_ = 0;
  uint16_t frames_dropped_ = 0;
  uint16_t commands_repeated_ = 0;
  Ring<wire::Event, 4> events_;
  Ring<wire::Step, 4> steps_;
};

}  // namespace firmware
}  // namespace lab
