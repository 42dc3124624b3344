#pragma once

namespace lab {
namespace dynamics {

/// What the wheels can do (paper, "Robot model"). Host only.
struct WheelLimits {
  double v_max = 0.27;        ///< Maximum wheel speed [m/s].
  double wheel_base = 0.075;  ///< d, the distance between the wheels [m].
};

}  // namespace dynamics
}  // namespace lab
