#include "robot/dynamics/program.hpp"

#include "robot/dynamics/exponential.hpp"
#include "robot/dynamics/motor.hpp"

namespace lab {
namespace dynamics {
namespace {

uint32_t atLeastOneMs(uint32_t ms) { return ms == 0 ? 1 : ms; }

}  // namespace

bool operator==(const ProgramParams& a, const ProgramParams& b) {
  return a.kind == b.kind && a.speed_um_s == b.speed_um_s && a.amplitude_um_s == b.amplitude_um_s &&
         a.hold_ms == b.hold_ms && a.mean_run_us == b.mean_run_us && a.tumble_ms == b.tumble_ms &&
         a.tumble_amplitude_um_s == b.tumble_amplitude_um_s && a.left_um_s == b.left_um_s &&
         a.right_um_s == b.right_um_s;
}

void Program::start(const ProgramParams& params) {
  params_ = params;
  tumble_next_ = false;
}

Hold Program::next(Rng& rng) {
  Hold hold;
  hold.duration_ms = kForever;
  switch (params_.kind) {
    case kNone:
      break;
    case kAbp: {
      const int32_t half_turn = uniformInt(rng, params_.amplitude_um_s);  // zeta d / 2
      hold.left_um_s = wrappingDifference(params_.speed_um_s, half_turn);
      hold.right_um_s = wrappingSum(params_.speed_um_s, half_turn);
      hold.duration_ms = atLeastOneMs(params_.hold_ms);
      break;
    }
    case kNoisyAbp:
    case kBp:
      hold.left_um_s = wrappingSum(params_.speed_um_s, uniformInt(rng, params_.amplitude_um_s));
      hold.right_um_s = wrappingSum(params_.speed_um_s, uniformInt(rng, params_.amplitude_um_s));
      hold.duration_ms = atLeastOneMs(params_.hold_ms);
      break;
    case kRtp:
      return nextRunOrTumble(rng);
    case kWheels:
      hold.left_um_s = params_.left_um_s;
      hold.right_um_s = params_.right_um_s;
      break;
  }
  return hold;
}

Hold Program::nextRunOrTumble(Rng& rng) {
  Hold hold;
  hold.tumble = tumble_next_;
  tumble_next_ = !tumble_next_;
  if (hold.tumble) {
    const int32_t turn = uniformInt(rng, params_.tumble_amplitude_um_s);
    hold.left_um_s = wrappingDifference(0, turn);
    hold.right_um_s = turn;
    hold.duration_ms = atLeastOneMs(params_.tumble_ms);
  } else {
    hold.left_um_s = params_.speed_um_s;
    hold.right_um_s = params_.speed_um_s;
    hold.duration_ms = exponentialMs(rng, params_.mean_run_us);
  }
  return hold;
}

}  // namespace dynamics
}  // namespace lab
