#pragma once

#include <stdint.h>

#include "robot/dynamics/robot_core.hpp"
#include "robot/wire/fields.hpp"

// The messages between host and robot (docs/protocol.md describes every byte). Each struct lists
// its fields once, in their order on the wire; writing, reading, size and schema use this list.

namespace lab {
namespace wire {

/// A hash of the fields of all messages, see robot/wire/schema.hpp. A robot reports it in HELLO,
/// and a host does not drive a robot with another schema.
constexpr uint16_t kSchema = 0x0FDE;  // compared by tests/robot/wire/schema_test.cpp

// ---- host to robot. Every command contains absolute values, never a difference, so that it can be
// repeated; each is answered by an ACK with its seq. ----

/// Measures the round trip and the robot's clock. Answered by PONG.
struct Ping {
  static constexpr uint8_t kType = 0x01;
  uint32_t token_high = 0;
  uint32_t token_low = 0;
  template <class M, class V>
  static constexpr void fields(M& m, V& v) {
    v(m.token_high);
    v(m.token_low);
  }
};

/// Asks for HELLO.
struct GetInfo {
  static constexpr uint8_t kType = 0x02;
  template <class M, class V>
  static constexpr void fields(M&, V&) {}
};

/// Stages the program of one slot. Nothing changes before APPLY.
struct SetProgram {
  static constexpr uint8_t kType = 0x10;
  uint8_t slot = 0;
  uint32_t hash = 0;  ///< 0: the robot stands
  template <class M, class V>
  static constexpr void fields(M& m, V& v) {
    v(m.slot);
    v(m.hash);
  }
};

/// Stages the light bands (LightSettings).
struct SetLight {
  static constexpr uint8_t kType = 0x11;
  uint8_t count = 0;
  uint8_t reading = 0;
  uint16_t hysteresis = 0;
  uint16_t low[dynamics::kSlots] = {};
  uint16_t high[dynamics::kSlots] = {};
  uint8_t slot[dynamics::kSlots] = {};
  template <class M, class V>
  static constexpr void fields(M& m, V& v) {
    v(m.count);
    v(m.reading);
    v(m.hysteresis);
    for (uint8_t i = 0; i < dynamics::kSlots; ++i) {
      v(m.low[i]);
      v(m.high[i]);
      v(m.slot[i]);
    }
  }
};

template <>
struct Reordered<SetLight> {
  static constexpr bool kValue = true;
};

/// Stages the reversal (ReversalSettings), the largest wheel speed, the sensor period, and what
/// programs know of their robot.
struct SetMotion {
  static constexpr uint8_t kType = 0x12;
  uint8_t reversal = 0;  ///< 1: enabled
  uint32_t distance_um = 0;
  int32_t speed_um_s = 0;
  uint16_t ir_margin = 0;
  int32_t max_wheel_um_s = 0;
  uint16_t sensor_period_ms = 0;
  uint16_t robot_id = 0;
  int32_t half_wheel_base_um = 0;
  template <class M, class V>
  static constexpr void fields(M& m, V& v) {
    v(m.reversal);
    v(m.distance_um);
    v(m.speed_um_s);
    v(m.ir_margin);
    v(m.max_wheel_um_s);
    v(m.sensor_period_ms);
    v(m.robot_id);
    v(m.half_wheel_base_um);
  }
};

/// Puts all staged settings in force at once, if their CRC (configCrc) is this one, they have no
/// fault, and the robot has their programs. Settings equal to those in force change nothing.
struct Apply {
  static constexpr uint8_t kType = 0x13;
  uint16_t config = 0;
  template <class M, class V>
  static constexpr void fields(M& m, V& v) {
    v(m.config);
  }
};

/// What the robot is to do now, repeated at 5 Hz. It shows that the host is alive: the robot may
/// move for lease_ms after its reception. Refused while other settings than `config` are in force.
struct Order {
  static constexpr uint8_t kType = 0x14;
  static constexpr uint8_t kStand = 0;
  static constexpr uint8_t kTable = 1;
  static constexpr uint8_t kDrive = 2;
  uint8_t id = 0;  ///< number of the host's order, echoed in TELEMETRY
  uint8_t mode = kStand;
  uint16_t config = 0;
  int32_t left_um_s = 0;   ///< kDrive
  int32_t right_um_s = 0;  ///< kDrive
  uint32_t lease_ms = 0;
  template <class M, class V>
  static constexpr void fields(M& m, V& v) {
    v(m.id);
    v(m.mode);
    v(m.config);
    v(m.left_um_s);
    v(m.right_um_s);
    v(m.lease_ms);
  }
};

/// Stops and latches, or releases the latch. Executed before any other waiting command.
struct Stop {
  static constexpr uint8_t kType = 0x15;
  static constexpr uint8_t kStop = 0x5A;
  static constexpr uint8_t kRelease = 0xA5;
  uint8_t id = 0;  ///< number of the host's request, echoed in TELEMETRY
  uint8_t action = kStop;
  template <class M, class V>
  static constexpr void fields(M& m, V& v) {
    v(m.id);
    v(m.action);
  }
};

/// Seeds the random numbers. The seed already in force changes nothing, so that a repeated command
/// does not repeat draws.
struct SetSeed {
  static constexpr uint8_t kType = 0x16;
  uint32_t high = 0;
  uint32_t low = 0;
  template <class M, class V>
  static constexpr void fields(M& m, V& v) {
    v(m.high);
    v(m.low);
  }
};

/// Sets one of the robot's own settings, see Param. The value is kept until the next reset; after
/// COMMIT it is kept permanently.
struct SetParam {
  static constexpr uint8_t kType = 0x17;
  uint8_t id = 0;
  int32_t value = 0;
  template <class M, class V>
  static constexpr void fields(M& m, V& v) {
    v(m.id);
    v(m.value);
  }
};

/// Asks for one setting; answered by PARAM.
struct GetParam {
  static constexpr uint8_t kType = 0x18;
  uint8_t id = 0;
  template <class M, class V>
  static constexpr void fields(M& m, V& v) {
    v(m.id);
  }
};

/// Writes the settings into the EEPROM. Refused (kBusy) while the robot moves, because each byte
/// takes 3.4 ms.
struct Commit {
  static constexpr uint8_t kType = 0x19;
  template <class M, class V>
  static constexpr void fields(M&, V&) {}
};

/// Begins to load a program. The bytes are collected in RAM; a program that was begun before is
/// dropped. Refused (kNoPlace) if every place of the EEPROM has a program of settings in force or
/// staged.
struct LoadBegin {
  static constexpr uint8_t kType = 0x1A;
  uint32_t hash = 0;
  uint8_t size = 0;
  template <class M, class V>
  static constexpr void fields(M& m, V& v) {
    v(m.hash);
    v(m.size);
  }
};

/// Bytes of the program; those beyond its end are ignored. The order does not matter.
struct LoadData {
  static constexpr uint8_t kType = 0x1B;
  static constexpr uint8_t kBytes = 32;
  uint8_t offset = 0;
  uint8_t code[kBytes] = {};
  template <class M, class V>
  static constexpr void fields(M& m, V& v) {
    v(m.offset);
    for (uint8_t i = 0; i < kBytes; ++i) {
      v(m.code[i]);
    }
  }
};

/// Checks the program (CRC-32 and byte code) and writes it into the EEPROM. Answered when it is
/// stored, about 0.6 s later, or at once if it was stored before.
struct LoadEnd {
  static constexpr uint8_t kType = 0x1C;
  uint32_t hash = 0;
  template <class M, class V>
  static constexpr void fields(M& m, V& v) {
    v(m.hash);
  }
};

/// Asks for PROGRAMS.
struct GetPrograms {
  static constexpr uint8_t kType = 0x1D;
  template <class M, class V>
  static constexpr void fields(M&, V&) {}
};

/// The numbers that programs read as sense(0) to sense(7), in units of 2^-16. A stream: not
/// answered, and a lost message is replaced by the next one.
struct SetSenses {
  /// Of a serial line that these messages may take: 50 in a second fit at 38400 baud, and an order
  /// waits for one of them at most.
  static constexpr int kMostPercent = 60;
  static constexpr uint8_t kType = 0x1E;
  uint8_t id = 0;  ///< number of the message, echoed in TELEMETRY
  int32_t sense[dynamics::kSenses] = {};
  template <class M, class V>
  static constexpr void fields(M& m, V& v) {
    v(m.id);
    for (uint8_t i = 0; i < dynamics::kSenses; ++i) {
      v(m.sense[i]);
    }
  }
};

// ---- robot to host ----

struct Pong {
  static constexpr uint8_t kType = 0x81;
  uint32_t token_high = 0;
  uint32_t token_low = 0;
  uint32_t t_ms = 0;  ///< the robot's clock when PING was complete
  uint16_t t_us = 0;  ///< microseconds within that millisecond
  template <class M, class V>
  static constexpr void fields(M& m, V& v) {
    v(m.token_high);
    v(m.token_low);
    v(m.t_ms);
    v(m.t_us);
  }
};

enum ResetCause : uint8_t {
  kResetUnknown = 0,  ///< a bootloader cleared the register
  kResetPower = 1,
  kResetPin = 2,
  kResetBrownOut = 3,
  kResetWatchdog = 4,
};

/// Identifies the robot. Sent at boot, then every second until the first good frame is received,
/// and in answer to GET_INFO.
struct Hello {
  static constexpr uint8_t kType = 0x82;
  uint16_t schema = 0;
  uint16_t firmware = 0;  ///< major * 256 + minor
  uint32_t build = 0;     ///< first 8 hex digits of the commit
  uint32_t uid = 0;       ///< number stored in the EEPROM; 0: none was ever stored
  uint16_t boot_id = 0;   ///< differs after every reset
  uint8_t reset_cause = 0;
  uint8_t board = 0;          ///< 1: Pro Mini 3.3 V 8 MHz; 2: the firmware compiled for a host
  uint8_t settings_from = 0;  ///< EEPROM bank 0 or 1, 255: defaults
  uint32_t uptime_ms = 0;
  uint32_t baud = 0;
  template <class M, class V>
  static constexpr void fields(M& m, V& v) {
    v(m.schema);
    v(m.firmware);
    v(m.build);
    v(m.uid);
    v(m.boot_id);
    v(m.reset_cause);
    v(m.board);
    v(m.settings_from);
    v(m.uptime_ms);
    v(m.baud);
  }
};

enum AckStatus : uint8_t {
  kOk = 0,
  kUnknownType = 1,  ///< the host is newer than the robot
  kBadLength = 2,
  kBadValue = 3,     ///< detail: index of the field on the wire; for APPLY a ConfigFault
  kWrongConfig = 4,  ///< ORDER or APPLY for other settings than those in the robot
  kBusy = 5,
  kStoreFailed = 6,  ///< the EEPROM reads back other bytes than were written
  kMissing = 7,      ///< APPLY: the robot does not have the program of the slot in `detail`
  kNoPlace = 8,      ///< LOAD_BEGIN, LOAD_END: all places have programs in use
  kBadProgram = 9,   ///< LOAD_END: detail: a ByteCodeFault; 0: wrong CRC
};

/// The answer to every command except PING, GET_INFO, GET_PARAM, GET_PROGRAMS and SET_SENSES, with
/// the command's seq.
struct Ack {
  static constexpr uint8_t kType = 0x83;
  uint8_t type = 0;
  uint8_t status = 0;
  uint8_t detail = 0;
  template <class M, class V>
  static constexpr void fields(M& m, V& v) {
    v(m.type);
    v(m.status);
    v(m.detail);
  }
};

/// The quickly changing state, sent periodically; seq counts the messages.
struct Telemetry {
  static constexpr uint8_t kType = 0x90;
  uint32_t t_ms = 0;   ///< when sampled, on the robot's clock
  uint16_t flags = 0;  ///< CoreFlag
  uint8_t slot = 0;
  uint8_t phase = 0;
  uint16_t program_epoch = 0;  ///< low 16 bits
  int32_t left_um_s = 0;       ///< as driven now
  int32_t right_um_s = 0;      ///< as driven now
  uint16_t sensors[8] = {};    ///< front light, back light, six IR; 10 bits each
  uint16_t config = 0;         ///< CRC of the settings in force; 0: none
  uint8_t order_id = 0;
  uint8_t stop_id = 0;
  uint8_t senses_id = 0;  ///< of the last SET_SENSES
  template <class M, class V>
  static constexpr void fields(M& m, V& v) {
    v(m.t_ms);
    v(m.flags);
    v(m.slot);
    v(m.phase);
    v(m.program_epoch);
    v(m.left_um_s);
    v(m.right_um_s);
    v.counts10(m.sensors);
    v(m.config);
    v(m.order_id);
    v(m.stop_id);
    v(m.senses_id);
  }
};

/// The state of program and reversal. Sent with each change, before the telemetry that shows it,
/// and four times a second.
struct State {
  static constexpr uint8_t kType = 0x91;
  uint32_t t_ms = 0;
  uint16_t program_epoch = 0;
  uint32_t program = 0;  ///< hash of the running program; 0: none
  uint32_t program_start_ms = 0;
  int32_t held_left_um_s = 0;
  int32_t held_right_um_s = 0;
  uint16_t reversal_count = 0;
  uint32_t reversal_start_ms = 0;
  uint32_t reversal_end_ms = 0;
  uint16_t tumble_count = 0;
  template <class M, class V>
  static constexpr void fields(M& m, V& v) {
    v(m.t_ms);
    v(m.program_epoch);
    v(m.program);
    v(m.program_start_ms);
    v(m.held_left_um_s);
    v(m.held_right_um_s);
    v(m.reversal_count);
    v(m.reversal_start_ms);
    v(m.reversal_end_ms);
    v(m.tumble_count);
  }
};

/// One hold of a program, sent when it begins. All steps together are a complete record of the
/// program.
struct Step {
  static constexpr uint8_t kType = 0x92;
  uint32_t t_ms = 0;
  uint32_t draw_count = 0;  ///< since boot; a gap means a lost STEP
  uint16_t program_epoch = 0;
  uint8_t slot = 0;
  uint8_t phase = 0;
  int32_t left_um_s = 0;   ///< as held, after clamping
  int32_t right_um_s = 0;  ///< as held, after clamping
  uint32_t duration_ms = 0;
  uint32_t rng = 0;  ///< digest of the random generator's state after the draw
  template <class M, class V>
  static constexpr void fields(M& m, V& v) {
    v(m.t_ms);
    v(m.draw_count);
    v(m.program_epoch);
    v(m.slot);
    v(m.phase);
    v(m.left_um_s);
    v(m.right_um_s);
    v(m.duration_ms);
    v(m.rng);
  }
};

/// Counters, once a second. They wrap around.
struct Counters {
  static constexpr uint8_t kType = 0x93;
  uint32_t t_ms = 0;
  uint32_t run_time_ms = 0;
  uint32_t draw_count = 0;
  uint16_t saturation_count = 0;
  uint16_t battery_mv = 0;  ///< 0: not measured
  uint16_t frames_received = 0;
  uint16_t frames_bad = 0;         ///< CRC, length, version
  uint16_t bytes_overrun = 0;      ///< lost because they were read too late
  uint16_t frames_dropped = 0;     ///< telemetry, steps and events for which the line had no room
  uint16_t commands_repeated = 0;  ///< repeated commands: answered again, not executed again
  uint8_t stack_left = 0;          ///< smallest free RAM since boot, in units of 8 bytes
  template <class M, class V>
  static constexpr void fields(M& m, V& v) {
    v(m.t_ms);
    v(m.run_time_ms);
    v(m.draw_count);
    v(m.saturation_count);
    v(m.battery_mv);
    v(m.frames_received);
    v(m.frames_bad);
    v(m.bytes_overrun);
    v(m.frames_dropped);
    v(m.commands_repeated);
    v(m.stack_left);
  }
};

enum EventCode : uint8_t {
  kBooted = 1,           ///< data: ResetCause
  kLeaseOver = 2,        ///< the host is silent; the robot stands
  kStopLatched = 3,      ///< data: the stop's id
  kStopReleased = 4,     ///< data: the stop's id
  kWatchdogRestart = 5,  ///< the firmware hung and the watchdog restarted it; the robot stands
  kSettingsDefault = 6,  ///< no EEPROM bank is valid; defaults are used
  kSettingsStored = 7,   ///< data: the bank
  kProgramStored = 8,    ///< data: the program's hash
};

/// A single event. The other messages show its consequences, so it may be lost.
struct Event {
  static constexpr uint8_t kType = 0x94;
  uint32_t t_ms = 0;
  uint16_t number = 0;  ///< since boot, from 1; a gap means a lost event
  uint8_t code = 0;
  uint32_t data = 0;
  template <class M, class V>
  static constexpr void fields(M& m, V& v) {
    v(m.t_ms);
    v(m.number);
    v(m.code);
    v(m.data);
  }
};

/// The answer to GET_PARAM.
struct ParamValue {
  static constexpr uint8_t kType = 0x95;
  uint8_t id = 0;
  int32_t value = 0;
  template <class M, class V>
  static constexpr void fields(M& m, V& v) {
    v(m.id);
    v(m.value);
  }
};

/// Number of programs in the robot's EEPROM.
constexpr uint8_t kProgramPlaces = 5;

/// The answer to GET_PROGRAMS: the hashes of the stored programs; 0: no program in this place.
struct Programs {
  static constexpr uint8_t kType = 0x96;
  uint32_t hash[kProgramPlaces] = {};
  uint32_t running = 0;  ///< the hash of the running program; 0: none
  template <class M, class V>
  static constexpr void fields(M& m, V& v) {
    for (uint8_t i = 0; i < kProgramPlaces; ++i) {
      v(m.hash[i]);
    }
    v(m.running);
  }
};

/// The robot's own settings, by number.
enum Param : uint8_t {
  kUid = 1,              ///< number of the electronics, 32 bits
  kGainLeft = 2,         ///< actual over nominal wheel speed, millionths (500000..1500000)
  kGainRight = 3,        ///< as kGainLeft
  kDeadBandLeft = 4,     ///< duty below which the wheel does not turn, 0..127
  kDeadBandRight = 5,    ///< as kDeadBandLeft
  kWheelBase = 6,        ///< micrometres, 10000..500000; stored for the host, which converts orders
  kTelemetryPeriod = 7,  ///< ms, 10..60000; 0: no telemetry; not stored
  kStepLog = 8,          ///< 1: send STEP with every draw; not stored
};

}  // namespace wire
}  // namespace lab
