#pragma once

#include <stdint.h>

#include "robot/dynamics/rng.hpp"

namespace lab {
namespace dynamics {

/// What a robot can be told to do. The numbers are those of the messages and of the wire protocol.
enum ProgramKind : uint8_t {
  kNone = 0,      ///< Stand still.
  kAbp = 1,       ///< Active Brownian particle.
  kNoisyAbp = 2,  ///< Active Brownian particle with translational noise: va > 0.
  kBp = 3,        ///< Brownian particle: va = 0.
  kRtp = 4,       ///< Run and tumble particle.
  kWheels = 5,    ///< Constant wheel speeds.
};

constexpr uint8_t kProgramKinds = 6;

/// A program in the robot's own integers: micrometre/s and milliseconds. What a kind does not name
/// it ignores. robot_program.hpp converts from SI and checks what the wheels can do.
struct ProgramParams {
  ProgramKind kind = kNone;
  int32_t speed_um_s = 0;             ///< v (ABP, RTP) or va (noisy ABP, BP).
  int32_t amplitude_um_s = 0;         ///< eta d / 2 (ABP) or V (noisy ABP, BP).
  uint32_t hold_ms = 0;               ///< epsilon (ABP, noisy ABP, BP).
  uint32_t mean_run_us = 0;           ///< 1 / gamma (RTP).
  uint32_t tumble_ms = 0;             ///< tau_t (RTP).
  int32_t tumble_amplitude_um_s = 0;  ///< pi d / (2 tau_t) (RTP).
  int32_t left_um_s = 0;              ///< Left wheel (constant wheel speeds).
  int32_t right_um_s = 0;             ///< Right wheel (constant wheel speeds).
};

bool operator==(const ProgramParams& a, const ProgramParams& b);
inline bool operator!=(const ProgramParams& a, const ProgramParams& b) { return !(a == b); }

/// Wheel speeds that are held for a time.
struct Hold {
  int32_t left_um_s = 0;
  int32_t right_um_s = 0;
  uint32_t duration_ms = 0;  ///< kForever: until something else happens.
  bool tumble = false;       ///< The robot turns on the spot to a new run direction.
};

/// The duration of a hold that never ends by itself.
constexpr uint32_t kForever = 0xFFFFFFFFUL;

/// One program as a sequence of holds. The random numbers come from outside, so that one stream of
/// a robot serves all its programs.
///
/// - ABP (eqs. 1 to 3): zeta uniform in [-eta, eta], held for epsilon; v_l = v - zeta d / 2 and
///   v_r = v + zeta d / 2, so that theta' = (v_r - v_l) / d = zeta. The paper's eq. 3 has the two
///   signs the other way round, which eq. 1 turns into theta' = -zeta; for a symmetric zeta that
///   cannot be seen in any average, for a tumble or a biased zeta it can.
/// - Noisy ABP and BP: v_l and v_r independent, uniform in [va - V, va + V], held for epsilon.
/// - RTP: a straight run at v for an exponential time of mean 1 / gamma (nearest millisecond, which
///   may be 0), then a tumble of tau_t on the spot by an angle uniform in (-180, 180] degrees. The
///   short way round is what the wheels can do: 0 to 360 degrees in 0.5 s needs 47 cm/s.
///
/// A hold or tumble of 0 ms, which only a broken message can ask for, lasts 1 ms.
class Program {
 public:
  /// Begins anew; the next hold is the first one. RTP begins with a run.
  void start(const ProgramParams& params);

  /// Draws the next hold.
  Hold next(Rng& rng);

  const ProgramParams& params() const { return params_; }

 private:
  Hold nextRunOrTumble(Rng& rng);

  ProgramParams params_;
  bool tumble_next_ = false;
};

}  // namespace dynamics
}  // namespace lab
