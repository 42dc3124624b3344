#include "common/experiment/experiment_conversions.hpp"

namespace lab {

dynamics::RobotProgram toPhysics(const ProgramSpec& program) {
  dynamics::RobotProgram physics;
  physics.kind = static_cast<dynamics::ProgramKind>(program.model);
  physics.v = program.v;
  physics.va = program.va;
  physics.V = program.V;
  physics.epsilon = program.epsilon;
  physics.eta = program.eta;
  physics.gamma = program.gamma;
  physics.tau_t = program.tau_t;
  physics.wheel_left = program.wheel_left;
  physics.wheel_right = program.wheel_right;
  return physics;
}

dynamics::WheelLimits wheelLimits(const RobotHardware& hardware) {
  return {hardware.max_wheel_speed, hardware.diameter};
}

light::Layer toLightLayer(const LayerSpec& layer) {
  light::Layer result;
  result.kind = static_cast<light::LayerKind>(layer.kind);
  result.blend = static_cast<light::Blend>(layer.blend);
  result.x = layer.x;
  result.y = layer.y;
  result.angle = layer.angle;
  result.size = layer.size;
  result.inner = layer.inner;
  result.softness = layer.softness;
  result.intensity = layer.intensity;
  result.intensity2 = layer.intensity2;
  result.seed = layer.seed;
  result.phase = layer.phase;
  return result;
}

bool contains(const LightBand& band, double light, double widened) {
  const bool full = light >= 1 && band.high >= 1;
  return light >= band.low - widened && (light < band.high + widened || full);
}

}  // namespace lab
