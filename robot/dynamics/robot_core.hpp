#pragma once

#include <stdint.h>

#include "robot/dynamics/light_table.hpp"
#include "robot/dynamics/motor.hpp"
#include "robot/dynamics/program.hpp"
#include "robot/dynamics/rng.hpp"

namespace lab {
namespace dynamics {

/// The infrared sensors sit on the rim, counter-clockwise from the front: 0, +60, +120, 180, -120
/// and -60 degrees. A reading is 0 with nothing in range and 1023 when touching.
constexpr uint8_t kIrSensors = 6;

/// What the robot measures in one scan, in counts 0..1023.
struct Sensors {
  uint16_t light_front = 0;
  uint16_t light_back = 0;
  uint16_t ir[kIrSensors] = {0, 0, 0, 0, 0, 0};
};

/// How the robot turns back from an obstacle (paper, Appendix B).
struct ReversalSettings {
  bool enabled = true;
  uint32_t distance_um = 400000UL;  ///< At most 4 m.
  int32_t speed_um_s = 100000L;
  uint16_t ir_margin = 8;  ///< Counts by which a reading must exceed its floor to be an approach.
};

/// Everything the host sets on a robot.
struct CoreSettings {
  LightSettings light;
  ProgramParams programs[kSlots];
  ReversalSettings reversal;
  int32_t max_wheel_um_s = kMaxWheelUmS;
  uint16_t sensor_period_ms = 20;  ///< How often the robot's owner is to call sense().
};

bool operator==(const CoreSettings& a, const CoreSettings& b);

/// Two wheel speeds in micrometre/s.
struct WheelSpeedsUmS {
  int32_t left = 0;
  int32_t right = 0;
};

/// The robot's flags. The bits 32, 64 and 128 are left to what only its surroundings know.
enum CoreFlag : uint16_t {
  kReversing = 1,       ///< Driving straight, away from an obstacle; the program is paused.
  kStopped = 2,         ///< The stop latch is set.
  kLeaseExpired = 4,    ///< The host is silent (or has never spoken).
  kSaturated = 8,       ///< The held wheel speeds were asked for beyond the limit and are clamped.
  kTumbling = 16,       ///< The hold is a tumble (also while paused by a reversal).
  kDriven = 256,        ///< The wheels are driven by hand.
  kNoLightBand = 512,   ///< No band contains the light (or nothing was measured yet).
  kUnconfigured = 1024  ///< configure() has not been called since boot.
};

/// What the robot says about itself.
struct CoreReport {
  uint8_t slot = kNoSlot;          ///< The slot now running (also while paused); kNoSlot if none.
  ProgramKind kind = kNone;        ///< What runs: kNone standing, kWheels also by hand.
  uint16_t flags = 0;              ///< CoreFlag bits.
  uint32_t program_epoch = 0;      ///< Counts starts: of programs, of driving by hand, of standing.
  uint32_t program_start_ms = 0;   ///< When the last of them was.
  uint32_t draw_count = 0;         ///< Holds begun since boot.
  uint32_t tumble_count = 0;       ///< Tumbles begun since boot.
  uint32_t saturation_count = 0;   ///< Holds clamped since boot.
  uint32_t reversal_count = 0;     ///< Reversals begun since boot.
  uint32_t reversal_start_ms = 0;  ///< When the last reversal began.
  uint32_t reversal_end_ms = 0;    ///< When the last finished reversal ended.
  WheelSpeedsUmS held;             ///< The program's wheel speeds, also while it is paused.
};

/// The program on the robot: pure state, no clock, no hardware. The firmware and the simulator own
/// one each and feed it with the robot's own time and sensor counts.
///
/// Time is the robot's clock in whole milliseconds; it may wrap around. Calls must not go back in
/// time. Every call first processes what fell due before it, each event at its own time.
///
/// The robot moves only while it is configured, has a lease and is not stopped:
/// - The stop latch outranks everything until clearStop().
/// - The lease is the host's heartbeat. When it expires the program ENDS and the wheels stand; when
///   it returns, the program starts with a fresh draw, as after any stop.
/// - Otherwise the light selects the program, or the wheels are driven by hand (no reversals then).
///
/// A light switch starts the new program with a fresh draw, also during a reversal: the new program
/// then waits, drawn and paused, for its end.
///
/// Reversals. A sensor approaches when its reading exceeds its floor by the margin; the floor is
/// the lowest reading seen since boot or the last reset (0 once the sensor has seen nothing). A
/// fixed threshold instead would trap a robot that is parallel to a wall or already leaves it.
/// While the program drives forward (v_l + v_r > 0), an approach in front (0, +-60 degrees) makes
/// the robot drive straight back; while it drives backward, one at the rear makes it drive straight
/// forward; during a tumble (v = 0) nothing does. Floors are reset to the present readings when a
/// reversal begins and when it ends. It ends after the distance, or early when a sensor in the
/// direction of driving approaches. Then the program resumes EXACTLY: same held speeds, same
/// remaining time; the track without the reversal is statistically the free one.
class RobotCore {
 public:
  /// Takes all settings. Equal settings change nothing (commands are repeated); other settings end
  /// what runs, forget the current light band and start afresh.
  void configure(uint32_t now_ms, const CoreSettings& settings);

  /// Seeds the random numbers of the draws to come.
  void seed(uint64_t seed_value) { rng_.seed(seed_value); }

  /// Lets the light select the program (as after boot).
  void runPrograms(uint32_t now_ms);

  /// Drives the wheels by hand; speeds are clamped to the limit.
  void driveWheels(uint32_t now_ms, int32_t left_um_s, int32_t right_um_s);

  /// Stands still until told otherwise.
  void stand(uint32_t now_ms);

  /// Sets and releases the stop latch.
  void stop(uint32_t now_ms);
  void clearStop(uint32_t now_ms);

  /// Allows motion for the next lease_ms (at most 2^30; 0 ends the lease now).
  void renewLease(uint32_t now_ms, uint32_t lease_ms);

  /// Takes one scan of the sensors.
  void sense(uint32_t now_ms, const Sensors& sensors);

  /// Processes everything due up to and including now_ms.
  void advanceTo(uint32_t now_ms);

  /// Processes the first event due by now_ms, if there is one; for owners that record every draw.
  bool advanceOne(uint32_t now_ms);

  /// When the wheel speeds may change next without a call from outside: the end of the hold, of the
  /// reversal or of the lease. now_ms + kNoEventMs if nothing is pending.
  uint32_t nextEventMs(uint32_t now_ms) const;
  static constexpr uint32_t kNoEventMs = 1UL << 30;

  /// What the wheels are to do now.
  WheelSpeedsUmS wheels() const;

  CoreReport report() const;

  /// The parts of report() without copying it: CoreFlag bits, and all the rest (its flags are not
  /// filled in).
  uint16_t flags() const;
  const CoreReport& record() const { return report_; }

  /// When the present hold began, and how long it was drawn to last (kForever: until something else
  /// happens; reversals not counted).
  uint32_t holdStartMs() const { return hold_start_ms_; }
  uint32_t holdDurationMs() const { return hold_duration_ms_; }

  /// How long the robot has been in runs of a run-and-tumble program since boot, reversals
  /// excluded: tumble_count / run time estimates gamma without bias (right-censored maximum
  /// likelihood).
  uint32_t runTimeMs(uint32_t now_ms) const;

  const CoreSettings& settings() const { return settings_; }
  const Sensors& sensors() const { return sensors_; }
  const Rng& rng() const { return rng_; }

 private:
  enum Mode : uint8_t { kTable, kDrive, kStand };
  enum Event : uint8_t { kNothing, kLeaseEnd, kReversalEnd, kHoldEnd };

  Event nextEvent(uint32_t now_ms, uint32_t& at_ms) const;
  void setMode(uint32_t now_ms, Mode mode);
  bool inRun() const { return report_.kind == kRtp && !tumbling_ && reversal_direction_ == 0; }
  void countRunTime(uint32_t now_ms);
  bool mayMove() const { return configured_ && leased_ && !stopped_; }
  void restart(uint32_t now_ms);
  void switchProgram(uint32_t now_ms);
  void startSelected(uint32_t now_ms);
  void beginHold(uint32_t now_ms);
  void beginReversal(uint32_t now_ms, int8_t direction);
  void endReversal(uint32_t now_ms);
  void resetFloors();
  uint8_t approachingSensors();

  CoreSettings settings_;
  LightTable light_;
  Program program_;
  Rng rng_;
  Sensors sensors_;
  uint16_t floor_[kIrSensors] = {1023, 1023, 1023, 1023, 1023, 1023};

  bool configured_ = false;
  bool stopped_ = false;
  bool leased_ = false;
  Mode mode_ = kTable;
  bool measured_ = false;
  bool tumbling_ = false;
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
  uint32_t run_time_ms_ = 0;  ///< Up to run_since_ms_.
  uint32_t run_since_ms_ = 0;
  CoreReport report_;  ///< Its flags are filled in when asked for.
};

}  // namespace dynamics
}  // namespace lab
