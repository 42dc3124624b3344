#pragma once

#include <stdint.h>

#include "robot/dynamics/rng.hpp"

namespace lab {
namespace dynamics {

/// The kinds of programs. The numbers are those of program_t and of the wire protocol.
enum ProgramKind : uint8_t {
  kNone = 0,      ///< Stand still.
  kAbp = 1,       ///< Active Brownian particle.
  kNoisyAbp = 2,  ///< Active Brownian particle with translational noise: va > 0.
  kBp = 3,        ///< Brownian particle: va = 0.
  kRtp = 4,       ///< Run and tumble particle.
  kWheels = 5,    ///< Constant wheel speeds.
};

constexpr uint8_t kProgramKinds = 6;

/// The parameters of a program in the robot's integer units. A kind ignores the parameters that it
/// is not listed for. robot_program.hpp converts from SI units and checks the wheels' limits.
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

/// Wheel speeds that are kept for a time.
struct Hold {
  int32_t left_um_s = 0;
  int32_t right_um_s = 0;
  uint32_t duration_ms = 0;  ///< kForever: it does not end by itself.
  bool tumble = false;       ///< A rotation on the spot to a new run direction.
};

/// The duration of a hold that never ends by itself.
constexpr uint32_t kForever = 0xFFFFFFFFUL;

/// One program as a sequence of holds. The random generator is passed in, because all programs of a
/// robot share one stream.
///
/// - ABP (eqs. 1 to 3): zeta uniform in [-eta, eta], held for epsilon; v_l = v - zeta d / 2 and
///   v_r = v + zeta d / 2, so that theta' = (v_r - v_l) / d = zeta. The paper's eq. 3 has the
///   opposite signs, which by eq. 1 give theta' = -zeta. For a symmetric zeta the averages are the
///   same; for a tumble or a biased zeta they are not.
/// - Noisy ABP and BP: v_l and v_r independent, uniform in [va - V, va + V], held for epsilon.
/// - RTP: a straight run at v for an exponential time of mean 1 / gamma (nearest millisecond, which
///   may be 0), then a tumble of tau_t on the spot by an angle uniform in (-180, 180] degrees.
///   Angles of 0 to 360 degrees would be too fast for the wheels: in 0.5 s they need 47 cm/s.
///
/// A hold or tumble of 0 ms, which only an invalid message can contain, lasts 1 ms.
class Program {
 public:
  /// Starts a program; the next hold is its first. RTP begins with a run.
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
