/// What an experiment file says, as the pure cores take it.
#pragma once

#include "common/experiment.hpp"
#include "dynamics/params_from_physics.hpp"
#include "light/layer.hpp"

namespace lab {

[[nodiscard]] dynamics::ProgramPhysics toPhysics(const ProgramSpec& program);

[[nodiscard]] dynamics::WheelLimits wheelLimits(const RobotHardware& hardware);

/// An image layer comes without its pixels and its SHA-256: who knows where the file lies adds them
/// (light/image.hpp).
[[nodiscard]] light::Layer toLightLayer(const LayerSpec& layer);

}  // namespace lab
