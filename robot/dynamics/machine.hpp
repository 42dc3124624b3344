#pragma once

#include <stdint.h>

#include "robot/dynamics/byte_code.hpp"
#include "robot/dynamics/fixed_point.hpp"
#include "robot/dynamics/rng.hpp"
#include "robot/dynamics/sensors.hpp"

namespace lab {
namespace dynamics {

/// What a program can read besides its state.
struct MachineInputs {
  Sensors sensors;             ///< The last scan.
  uint16_t battery_mv = 0;     ///< Supply voltage.
  uint16_t id = 0;             ///< The robot's number.
  uint32_t time_ms = 0;        ///< Since the start of the program.
  uint32_t phase_time_ms = 0;  ///< Since the beginning of the phase.
  uint32_t heading_turns = 0;  ///< Turned since the start of the program [2^-32 turns].
  uint32_t distance_um = 0;    ///< Driven since the start of the program.
  Fixed senses[kSenses] = {};  ///< The numbers that the host writes.
  int32_t half_wheel_base_um = 37500L;
};

/// What the wheels do in a phase, and for how long.
struct PhaseResult {
  int32_t left_um_s = 0;     ///< Left wheel [um/s], not limited to what the wheels can do.
  int32_t right_um_s = 0;    ///< Right wheel [um/s].
  uint32_t duration_ms = 0;  ///< kEndless: the hold does not end by itself.
};

/// The duration of a hold that never ends by itself.
constexpr uint32_t kEndless = 0xFFFFFFFFUL;

/// The longest other hold: one hour.
constexpr uint32_t kLongestHoldMs = 3600000UL;

/// So many holds of 0 ms may follow each other; the next one lasts 1 ms. Without this limit a
/// program could keep the robot busy for ever.
constexpr uint8_t kZeroHolds = 8;

/// A robot spends at most this share of its time on evaluations, in units of 256 cycles a
/// millisecond: half of 8 MHz. Without this limit, holds that are shorter than their evaluation
/// would leave no time to obey. A hold that is too short for the evaluations so far is lengthened.
constexpr uint8_t kComputingPerMs = 16;
/// So much may be in arrears: 15 ms of computing.
constexpr uint16_t kComputingInArrears = 480;
/// What beginning a hold costs besides its evaluation: setting the motors, reporting.
constexpr uint8_t kHoldOverhead = 32;

/// Executes a program of motion. It runs on the robot, in the simulator and on the host, with the
/// same result to the last bit.
class Machine {
 public:
  /// Starts a program that checkByteCode() accepts; the bytes must stay where they are. Without a
  /// program (size 0) the wheels stand.
  void start(const uint8_t* code, uint8_t size, const MachineInputs& inputs, Rng& rng);

  /// Begins the next phase: evaluates it and returns what the wheels do and for how long.
  PhaseResult next(const MachineInputs& inputs, Rng& rng);

  /// Whether the sensors end the present hold. If so, next() begins the phase that the program
  /// names for this case.
  bool interrupted(const MachineInputs& inputs, Rng& rng);

  /// Whether interrupted() can be true in the present phase.
  bool canBeInterrupted() const { return interruptible_; }

  uint8_t phase() const { return phase_; }
  Fixed state(uint8_t index) const { return states_[index % kStates]; }

  /// The number of blocks since boot with a result that was limited to the largest number, a
  /// division by zero, an impossible draw, or a hold beyond 0 ms to one hour; and of holds that
  /// were lengthened.
  uint32_t saturationCount() const { return saturations_; }

  /// Whether that number grew since the last call.
  bool takeSaturated() {
    const bool grew = grew_;
    grew_ = false;
    return grew;
  }

 private:
  void run(uint8_t block, const MachineInputs& inputs, Rng& rng);
  uint8_t phaseNumber(Fixed plain);
  bool lengthen(uint32_t& duration_ms);
  void count() {
    saturations_ += saturated_ ? 1U : 0U;
    grew_ = grew_ || saturated_;
  }

  const uint8_t* code_ = nullptr;
  uint8_t size_ = 0;
  uint8_t phase_ = 0;
  uint8_t next_phase_ = 0;
  uint8_t interruption_ = 0;  ///< Position of the present interruption block.
  uint8_t zero_holds_ = 0;
  bool interruptible_ = false;
  bool wheel_speeds_ = false;           ///< The speeds on the stack are those of the wheels.
  bool saturated_ = false;              ///< In the present block.
  bool grew_ = false;                   ///< See takeSaturated().
  uint8_t costs_[kLargestPhases] = {};  ///< of the evaluations, in units of 256 cycles
  uint16_t arrears_ = 0;                ///< computing not yet paid by holds, in the same unit
  Fixed states_[kStates] = {};
  Fixed stack_[kLargestStack] = {};
  uint32_t saturations_ = 0;
};

}  // namespace dynamics
}  // namespace lab
