/// What an experiment file says, as the pure cores take it.
#pragma once

#include "common/experiment/experiment.hpp"
#include "light/field/layer.hpp"
#include "robot/dynamics/robot_program.hpp"

namespace lab {

[[nodiscard]] dynamics::RobotProgram toPhysics(const ProgramSpec& program);

[[nodiscard]] dynamics::WheelLimits wheelLimits(const RobotHardware& hardware);

/// Whether the light lies in the band: half open, except that full light belongs to a band up to 1.
/// @param widened by this much on both sides, as a running program's band is by the hysteresis
[[nodiscard]] bool contains(const LightBand& band, double light, double widened = 0);

/// An image layer comes without its pixels and its SHA-256: who knows where the file lies adds them
/// (light/field/image.hpp).
[[nodiscard]] light::Layer toLightLayer(const LayerSpec& layer);

}  // namespace lab
