#include "robot/dynamics/kinematics.hpp"

#include <cmath>

#include "robot/dynamics/motor.hpp"

namespace lab {
namespace dynamics {
Arc makeArc(double left, double right, double wheel_base, double dt) {
  return makeArcOf((left + right) / 2, (right - left) / wheel_base, dt);
}

Pose apply(const Arc& arc, const Pose& pose) {
  const double c = std::cos(pose.theta);
  const double s = std::sin(pose.theta);
  Pose moved;
  moved.x = pose.x + c * arc.dx - s * arc.dy;
  moved.y = pose.y + s * arc.dx + c * arc.dy;
  moved.theta = pose.theta + arc.dtheta;
  return moved;
}

double wheelSpeed(int32_t um_s, const WheelModel& wheel) {
  bool saturated = false;
  const int32_t clamped = clampWheel(um_s, wheel.max_um_s, saturated);
  if (wheel.ideal) {
    return clamped * 1e-6 * wheel.gain;
  }
  const double step = wheel.max_um_s * 1e-6 / kMaxDuty;
  return dutyForSpeed(clamped, wheel.max_um_s) * step * wheel.gain;
}

}  // namespace dynamics
}  // namespace lab
