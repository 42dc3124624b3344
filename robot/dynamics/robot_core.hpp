#pragma once

#include <stdint.h>

#include "robot/dynamics/light_table.hpp"
#include "robot/dynamics/machine.hpp"
#include "robot/dynamics/motor.hpp"
#include "robot/dynamics/odometry.hpp"
#include "robot/dynamics/program_source.hpp"
#include "robot/dynamics/rng.hpp"
#include "robot/dynamics/sensors.hpp"

namespace lab {
namespace dynamics {

/// The robot's reversal in front of an obstacle (paper, Appendix B).
struct ReversalSettings {
  bool enabled = true;
  uint32_t distance_um = 400000UL;  ///< At most 4 m.
  int32_t speed_um_s = 100000L;
  uint16_t ir_margin =
      8;  ///< A reading above its baseline by more than this is an approach [counts].
};

/// All settings that the host sends to a robot.
struct CoreSettings {
  LightSettings light;
  uint32_t programs[kSlots] = {};  ///< The hashes of the programs; 0: stand.
  ReversalSettings reversal;
  int32_t max_wheel_um_s = kMaxWheelUmS;
  int32_t half_wheel_base_um = 37500L;
  uint16_t sensor_period_ms = 20;  ///< Period of the calls of sense().
  uint16_t robot_id = 0;           ///< What programs read as `id`.
};

bool operator==(const CoreSettings& a, const CoreSettings& b);

/// Two wheel speeds [um/s].
struct WheelSpeedsUmS {
  int32_t left = 0;
  int32_t right = 0;
};

/// The robot's flags. The bits 32, 64 and 128 are used by robot_state_t for other purposes.
enum CoreFlag : uint16_t {
  kReversing = 1,        ///< Driving straight, away from an obstacle; the program is paused.
  kStopped = 2,          ///< The stop latch is set.
  kLeaseExpired = 4,     ///< The lease has ended or was never given.
  kSaturated = 8,        ///< The speeds are clamped to the maximum, or a result was limited.
  kTumbling = 16,        ///< In a phase other than the first (also while paused by a reversal).
  kDriven = 256,         ///< The host sets the wheel speeds directly.
  kNoLightBand = 512,    ///< No band contains the light, or there was no scan yet.
  kUnconfigured = 1024,  ///< configure() has not been called since boot.
  kNoProgram = 2048      ///< The robot does not know the selected program, and stands.
};

/// The robot's report of its state.
struct CoreReport {
  uint8_t slot = kNoSlot;          ///< The slot now running (also while paused); kNoSlot if none.
  uint8_t phase = 0;               ///< The program's phase; 0 without a program.
  uint16_t flags = 0;              ///< CoreFlag bits.
  uint32_t program = 0;            ///< The running program's hash; 0: standing or direct driving.
  uint32_t program_epoch = 0;      ///< Number of starts (of programs, direct driving, standing).
  uint32_t program_start_ms = 0;   ///< Time of the last start.
  uint32_t draw_count = 0;         ///< Holds begun since boot.
  uint32_t tumble_count = 0;       ///< Holds begun in phases other than the first, since boot.
  uint32_t saturation_count = 0;   ///< Holds with kSaturated since boot.
  uint32_t reversal_count = 0;     ///< Reversals begun since boot.
  uint32_t reversal_start_ms = 0;  ///< When the last reversal began.
  uint32_t reversal_end_ms = 0;    ///< When the last finished reversal ended.
  WheelSpeedsUmS held;             ///< The program's wheel speeds, also while it is paused.
};

/// The robot's behaviour as a state machine without clock and hardware. The firmware and the
/// simulator each own one and pass it the robot's time and sensor counts.
///
/// Time is the robot's clock in whole milliseconds; it may wrap around. Calls must not go back in
/// time. Every call first processes all events before its time, each at its own time.
///
/// The robot moves only while it is configured, has a lease and is not stopped:
/// - The stop latch takes precedence over everything until clearStop().
/// - The lease shows that the host is alive. When it expires, the program ends and the wheels
///   stand. When it is renewed, the program starts with a fresh draw, as after any stop.
/// - Otherwise the light selects the program, or the host sets the wheel speeds directly. A robot
///   whose wheel speeds are set directly makes no reversals.
///
/// After each scan of the sensors the program may end its hold (`until`), except during a reversal:
/// then its time, its odometry and its phase are paused.
///
/// A change of the light band starts the new program with a fresh draw. During a reversal the new
/// program is drawn at once, but paused until the end of the reversal.
///
/// Reversals. A sensor detects an approach when its reading exceeds its baseline by the margin. The
/// baseline is the lowest reading since boot or since the last reset of the baselines (0 once
/// nothing was in range). With a fixed threshold, a robot that is parallel to a wall or already
/// leaves it would be trapped. While the program drives forward (v_l + v_r > 0), an approach in
/// front (0, +-60 degrees) makes the robot drive straight back. While it drives backward, an
/// approach at the rear makes it drive straight forward. During a tumble (v = 0) there is no
/// reversal. Baselines are reset to the present readings when a reversal begins and when it ends. A
/// reversal ends after the distance, or early when a sensor in the direction of driving detects an
/// approach. Then the program resumes with the same held speeds and the same remaining time, so the
/// track without the reversals has the statistics of free motion.
class RobotCore {
 public:
  /// @param programs outlives the core.
  explicit RobotCore(ProgramSource& programs) : programs_(&programs) {}

  /// Sets all settings. Equal settings change nothing, because commands are repeated. Other
  /// settings end the running program, forget the current light band and start again.
  void configure(uint32_t now_ms, const CoreSettings& settings);

  /// Seeds the random numbers of future draws.
  void seed(uint64_t seed_value) { rng_.seed(seed_value); }

  /// Lets the light select the program. This is the mode after boot.
  void runPrograms(uint32_t now_ms);

  /// Sets the wheel speeds directly; they are clamped to the limit.
  void driveWheels(uint32_t now_ms, int32_t left_um_s, int32_t right_um_s);

  /// Stands still until runPrograms() or driveWheels().
  void stand(uint32_t now_ms);

  /// Sets and releases the stop latch.
  void stop(uint32_t now_ms);
  void clearStop(uint32_t now_ms);

  /// Allows motion for the next lease_ms (at most 2^30; 0 ends the lease now).
  void renewLease(uint32_t now_ms, uint32_t lease_ms);

  /// Sets a number that programs read as `sense(index)`, or the supply voltage. Blocks that are due
  /// before must have been processed, see advanceTo().
  void setSense(uint8_t index, Fixed value) { inputs_.senses[index % kSenses] = value; }
  void setBattery(uint16_t mv) { inputs_.battery_mv = mv; }

  /// Takes one scan of the sensors.
  void sense(uint32_t now_ms, const Sensors& sensors);

  /// Processes everything due up to and including now_ms.
  void advanceTo(uint32_t now_ms);

  /// Processes the first event up to now_ms. Returns false if there is none. For callers that
  /// record every draw.
  bool advanceOne(uint32_t now_ms);

  /// When the wheel speeds may change next by themselves: the end of the hold, of the reversal or
  /// of the lease. now_ms + kNoEventMs if nothing is pending.
  uint32_t nextEventMs(uint32_t now_ms) const;
  static constexpr uint32_t kNoEventMs = 1UL << 30;

  /// The wheel speeds to be driven now.
  WheelSpeedsUmS wheels() const;

  CoreReport report() const;

  /// The same as report() without a copy: flags() returns the CoreFlag bits, record() everything
  /// else (its flags are not set).
  uint16_t flags() const;
  const CoreReport& record() const { return report_; }

  /// When the present hold began, and its duration without reversals (kEndless: it does not end by
  /// itself).
  uint32_t holdStartMs() const { return hold_start_ms_; }
  uint32_t holdDurationMs() const { return hold_duration_ms_; }

  /// Time in the first phase of programs since boot, without reversals. Where the
  /// first phase is a run, tumble_count / run time is the maximum likelihood estimate of the rate
  /// at which runs end, with right-censored runs.
  uint32_t runTimeMs(uint32_t now_ms) const;

  const CoreSettings& settings() const { return settings_; }
  const Sensors& sensors() const { return inputs_.sensors; }
  const Machine& machine() const { return machine_; }
  const Odometry& odometry() const { return odometry_; }
  const Rng& rng() const { return rng_; }

 private:
  enum Mode : uint8_t { kTable, kCommanded, kStand };
  enum Event : uint8_t { kNothing, kLeaseEnd, kReversalEnd, kHoldEnd };

  Event nextEvent(uint32_t now_ms, uint32_t& at_ms) const;
  void setMode(uint32_t now_ms, Mode mode);
  bool inRun() const {
    return report_.program != 0 && report_.phase == 0 && reversal_direction_ == 0;
  }
  void countTime(uint32_t now_ms);
  bool mayMove() const { return configured_ && leased_ && !stopped_; }
  void restart(uint32_t now_ms);
  void switchProgram(uint32_t now_ms);
  void startSelected(uint32_t now_ms);
  void updateInputs();
  void beginHold(uint32_t now_ms);
  void lookForInterruption(uint32_t now_ms);
  void beginReversal(uint32_t now_ms, int8_t direction);
  void endReversal(uint32_t now_ms);
  void resetBaselines();
  uint8_t approachingSensors();

  CoreSettings settings_;
  LightTable light_;
  ProgramSource* programs_;
  Machine machine_;
  MachineInputs inputs_;
  Odometry odometry_;
  Rng rng_;
  uint16_t baseline_[kIrSensors] = {1023, 1023, 1023, 1023, 1023, 1023};

  bool configured_ = false;
  bool stopped_ = false;
  bool leased_ = false;
  Mode mode_ = kTable;
  bool measured_ = false;
  bool missing_ = false;  ///< The selected program is not known.
  bool saturated_ = false;
  bool hold_ends_ = false;
  int8_t reversal_direction_ = 0;  ///< +1 forward, -1 backward, 0 not reversing.

  WheelSpeedsUmS driven_wheels_;
  uint32_t lease_end_ms_ = 0;
  uint32_t hold_start_ms_ = 0;
  uint32_t hold_duration_ms_ = 0;
  uint32_t hold_end_ms_ = 0;
  uint32_t hold_remaining_ms_ = 0;  ///< While paused.
  uint32_t reversal_due_ms_ = 0;
  uint32_t run_time_ms_ = 0;      ///< Up to counted_ms_, as the odometry and the two times below.
  uint32_t program_time_ms_ = 0;  ///< Of the program, without reversals.
  uint32_t phase_begin_ms_ = 0;   ///< In the program's time.
  uint32_t counted_ms_ = 0;
  CoreReport report_;  ///< Its flags are only set in report().
};

}  // namespace dynamics
}  // namespace lab
